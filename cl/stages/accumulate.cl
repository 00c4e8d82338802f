// accumulate: adds the samples of the batch to the film, each pixel's in the order of their index, so that no bit depends on how they were scheduled.
//
// From: the sample buffer, when all samples of the batch are done. To: the film.
// Sums are compensated (Kahan 1965); the variance of radiance is Welford's (1962).

#include "lib/math.cl"

kernel WORK_GROUP void accumulate(global const float *samples, uint sample_stride, global float *film, uint film_stride,
                                  global uint *non_finite, global const batch_t *batch
#ifdef PIXEL_LIST
                                  , global const uint2 *pixel_list
#endif
                                  )
{
    uint pixel = (uint)get_global_id(0);
    if (pixel >= batch->pixel_count)
        return;
    uint count = batch->samples_a_pixel, first_sample = batch->first_sample;
#ifdef PIXEL_LIST
    // Entries of one pixel follow one another; their first one's work-item adds them all.
    uint ordinal = pixel_list[pixel].x;
    if (pixel > 0u && pixel_list[pixel - 1u].x == ordinal)
        return;
    first_sample = pixel_list[pixel].y;
    uint entries = 1u;
    while (pixel + entries < batch->pixel_count && pixel_list[pixel + entries].x == ordinal)
        entries++;
    uint first = pixel * count;
    count *= entries;
#else
    uint ordinal = batch->first_pixel + pixel, first = pixel * count;
#endif
    global float *out = film + ordinal;
    for (uint channel = 0u; channel < CHANNEL_COUNT; ++channel) {
        global float *sum_at = out + (size_t)(2u * channel) * film_stride, *error_at = sum_at + film_stride;
        float sum = *sum_at, error = *error_at;
        float m2 = channel < 3u ? out[(size_t)(2u * CHANNEL_COUNT + channel) * film_stride] : 0.0f;
        float mean = first_sample > 0u ? sum / (float)first_sample : 0.0f;
        for (uint i = 0u; i < count; ++i) {
            uint sample = first + i;
            uint index = first_sample + i;
            float x = samples[(size_t)channel * sample_stride + sample];
            if (!is_finite(x)) {
                bool counted = false;  // a sample counts once, whichever of its channels are not finite
                for (uint before = 0u; before < channel; ++before)
                    counted = counted || !is_finite(samples[(size_t)before * sample_stride + sample]);
                uint known = counted ? NON_FINITE_KEPT : atomic_inc(non_finite);
                if (known < NON_FINITE_KEPT) {
                    non_finite[1u + 2u * known] = ordinal;
                    non_finite[2u + 2u * known] = index;
                }
                x = 0.0f;
            }
            if (channel >= FIRST_ID_CHANNEL) {
                sum = index == 0u ? x : sum;
                continue;
            }
            float y = x - error;
            float total = sum + y;
            error = (total - sum) - y;
            sum = total;
            float mean_after = sum / (float)(index + 1u);
            m2 += (x - mean) * (x - mean_after);
            mean = mean_after;
        }
        *sum_at = sum;
        *error_at = error;
        if (channel < 3u)
            out[(size_t)(2u * CHANNEL_COUNT + channel) * film_stride] = m2;
    }
}
