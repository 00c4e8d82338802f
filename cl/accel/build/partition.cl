// The primitives of a level's large nodes, the left side's before the right's, into another buffer; and the bounds of either side. A chunk a work-group,
// in which each work-item takes a run of neighbours, so that everything keeps its order. The node's histogram has been read and is emptied for the next level.

#include "accel/build/split.cl"

static inline bool partition_left(const plane_t *plane, const grid_t *grid, uint at, float8 box)
{
    if (plane->last == NO_PLANE)
        return at < plane->middle;
    return grid_bin(grid, BINS, plane->axis, box_centre(box)) <= plane->last;
}

static inline void box_join_group(local uint *keys, float8 box)
{
    atomic_min(keys, float_key(box.s0));
    atomic_min(keys + 1, float_key(box.s1));
    atomic_min(keys + 2, float_key(box.s2));
    atomic_min(keys + 3, float_key(box.s4));
    atomic_min(keys + 4, float_key(box.s5));
    atomic_min(keys + 5, float_key(box.s6));
}

KERNEL void partition(global const counters_t *counters, const uint level, global const open_t *open, global const chunk_t *chunks,
                      global const plane_t *planes, global const float8 *primitives, global const uint *bounds, global float8 *parted,
                      global uint *side_bounds, global uint *histogram_boxes, global uint *histogram_counts)
{
    uint chunk = (uint)get_group_id(0), local_id = (uint)get_local_id(0);
    if (chunk >= counters->chunks[level])
        return;
    uint node = chunks[chunk].node;
    if (chunk == open[node].first_chunk) {
        for (uint i = local_id; i < 6u * 3u * BINS; i += GROUP)
            histogram_boxes[6u * 3u * BINS * (size_t)node + i] = 0xffffffffu;
        for (uint i = local_id; i < 3u * BINS; i += GROUP)
            histogram_counts[3u * BINS * (size_t)node + i] = 0u;
    }
    grid_t grid = grid_over(box_of_keys(bounds + 12u * open[node].bounds + 6u), BINS);
    plane_t plane = planes[level * counters->room + node];
    uint run = (chunks[chunk].count + GROUP - 1u) / GROUP, count = chunks[chunk].count;
    uint begin = min(local_id * run, count), end = min(begin + run, count), first = chunks[chunk].first;
    uint left = chunks[chunk].left;
#if GROUP > 1
    local uint lefts[GROUP], keys[24];
    uint left_here = 0u;
    for (uint i = begin; i < end; i++)
        left_here += partition_left(&plane, &grid, first + i, primitives[first + i]);
    lefts[local_id] = left_here;
    for (uint i = local_id; i < 24u; i += GROUP)
        keys[i] = 0xffffffffu;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = 0u; i < local_id; i++)
        left += lefts[i];
#endif
    // Of those before this run in the node, `left` are left.
    uint to_left = open[node].first + left, to_right = plane.middle + (first + begin - open[node].first - left);
    float8 left_box = box_nothing(), left_centres = box_nothing(), right_box = box_nothing(), right_centres = box_nothing();
    for (uint i = begin; i < end; i++) {
        float8 box = primitives[first + i], centre = box_centre(box);
        bool goes_left = partition_left(&plane, &grid, first + i, box);
        parted[goes_left ? to_left : to_right] = box;
        to_left += goes_left;
        to_right += !goes_left;
        left_box = box_join(left_box, goes_left ? box : box_nothing());
        left_centres = box_join(left_centres, goes_left ? centre : box_nothing());
        right_box = box_join(right_box, goes_left ? box_nothing() : box);
        right_centres = box_join(right_centres, goes_left ? box_nothing() : centre);
    }
    global uint *sides = side_bounds + 24u * node;
#if GROUP > 1
    box_join_group(keys, left_box);
    box_join_group(keys + 6, left_centres);
    box_join_group(keys + 12, right_box);
    box_join_group(keys + 18, right_centres);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = local_id; i < 24u; i += GROUP)
        atomic_min(sides + i, keys[i]);
#else
    box_join_keys(sides, left_box);
    box_join_keys(sides + 6, left_centres);
    box_join_keys(sides + 12, right_box);
    box_join_keys(sides + 18, right_centres);
#endif
}
