// The sample buffer: what each sample of the batch has gathered, one array a channel.

#include "lib/math.cl"

static inline void sample_add(const samples_t *samples, uint channel, uint sample, float3 value)
{
    global float *p = samples->values + (size_t)channel * samples->stride + sample;
    p[0] += value.x;
    p[samples->stride] += value.y;
    p[2 * (size_t)samples->stride] += value.z;
}

static inline void sample_set(const samples_t *samples, uint channel, uint sample, float value)
{
    samples->values[(size_t)channel * samples->stride + sample] = value;
}

// Radiance that reaches the film after `depth` scattering events.
static inline void sample_add_radiance(const scene_t *scene, const samples_t *samples, uint sample, uint depth, float3 radiance)
{
#ifdef CLAMP_INDIRECT
    if (depth > 1u)
        radiance *= fmin(1.0f, scene->render->clamp_indirect / fmax(max_component(radiance), 1e-30f));
#endif
    sample_add(samples, CHANNEL_RADIANCE, sample, radiance);
#ifdef CHANNEL_EMISSION
    if (depth == 0u)
        sample_add(samples, CHANNEL_EMISSION, sample, radiance);
#endif
#ifdef CHANNEL_DIRECT
    if (depth == 1u)
        sample_add(samples, CHANNEL_DIRECT, sample, radiance);
#endif
#ifdef CHANNEL_INDIRECT
    if (depth > 1u)
        sample_add(samples, CHANNEL_INDIRECT, sample, radiance);
#endif
}
