// The histograms of a level's large nodes, a chunk of primitives a work-group: counts and boxes by axis and bin. A work-group of one has them in private
// memory, a larger one joins them by integer minima, which come out the same in any order.

#include "accel/build/histogram.cl"

KERNEL void bin(global const counters_t *counters, const uint level, global const open_t *open, global const chunk_t *chunks,
                global const float8 *primitives, global const uint *bounds, global uint *histogram_boxes, global uint *histogram_counts,
                global uint *chunk_counts)
{
    uint chunk = (uint)get_group_id(0), local_id = (uint)get_local_id(0);
    if (chunk >= counters->chunks[level])
        return;
    uint node = chunks[chunk].node;
    uint first = chunks[chunk].first, count = chunks[chunk].count;
    grid_t grid = grid_over(box_of_keys(bounds + 12u * open[node].bounds + 6u), BINS);
#if GROUP > 1
    local uint counts[3u * BINS];
    local uint keys[6u * 3u * BINS];
    for (uint i = local_id; i < 6u * 3u * BINS; i += GROUP)
        keys[i] = 0xffffffffu;
    for (uint i = local_id; i < 3u * BINS; i += GROUP)
        counts[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = local_id; i < count; i += GROUP) {
        float8 box = primitives[first + i];
        uint key[6] = {float_key(box.s0), float_key(box.s1), float_key(box.s2), float_key(box.s4), float_key(box.s5), float_key(box.s6)};
        int4 bins = grid_bins(&grid, BINS, box_centre(box));
        uint at_axis[3] = {(uint)bins.x, BINS + (uint)bins.y, 2u * BINS + (uint)bins.z};
        for (uint axis = 0u; axis < 3u; axis++) {
            uint at = at_axis[axis];
            atomic_inc(counts + at);
            for (uint side = 0u; side < 6u; side++)
                atomic_min(keys + 6u * at + side, key[side]);
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = local_id; i < 6u * 3u * BINS; i += GROUP)
        if (counts[i / 6u])
            atomic_min(histogram_boxes + 6u * 3u * BINS * (size_t)node + i, keys[i]);
#else
    uint counts[3u * BINS];
    float8 boxes[3u * BINS];
    histogram_fill(boxes, counts, primitives + first, count, &grid, BINS);
    for (uint i = 0u; i < 3u * BINS; i++)
        if (counts[i])
            box_join_keys(histogram_boxes + 6u * (3u * BINS * (size_t)node + i), boxes[i]);
#endif
    for (uint i = local_id; i < 3u * BINS; i += GROUP)
        if (counts[i])
            atomic_add(histogram_counts + 3u * BINS * (size_t)node + i, counts[i]);
    // How many of the chunk are in a bin or one before it.
    for (uint axis = local_id; axis < 3u; axis += GROUP) {
        uint sum = 0u;
        for (uint i = axis * BINS; i < (axis + 1u) * BINS; i++) {
            sum += counts[i];
            chunk_counts[3u * BINS * (size_t)chunk + i] = sum;
        }
    }
}
