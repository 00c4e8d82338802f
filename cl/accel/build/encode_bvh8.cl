// The arrays of lumiere/accel/bvh8.py, a pair of nodes at a time. Wide nodes have the order of their pairs, but the root comes first.

#include "accel/build/wide.cl"

static inline uint bvh8_number(global const uint *wide_ranks, uint pair, uint root)
{
    uint number = wide_ranks[pair] - 1u, of_root = wide_ranks[root] - 1u;
    return pair == root ? 0u : number < of_root ? number + 1u : number;
}

// The children of the wide node that begins with a pair, as slots of binary nodes, by growing area. Returns how many.
static inline uint bvh8_children(global const build_node_t *nodes, global const uint *shares, uint pair, float scale, uint *slots)
{
    uint count = wide_children(nodes, shares, pair, slots);
    float areas[WIDTH];
    for (uint i = 0u; i < count; i++) {
        uint slot = slots[i], at = i;
        float area = box_area(node_box(nodes + slot), scale);
        for (; at > 0u && areas[at - 1u] > area; at--) {
            areas[at] = areas[at - 1u];
            slots[at] = slots[at - 1u];
        }
        areas[at] = area;
        slots[at] = slot;
    }
    return count;
}

KERNEL void encode_bvh8(global const build_node_t *nodes, global const uint *ranks, global const uint *wide_ranks, global const uint *shares,
                        const uint count, const uint span, global uint *wide)
{
    uint begin = (uint)get_global_id(0) * span, root = nodes[0].link;
    if (begin >= count)
        return;
    float scale = box_unit_scale(node_box(nodes));
    for (uint pair = max(begin, 1u); pair < begin + min(span, count - begin); pair++) {
        if (wide_ranks[pair] == wide_ranks[pair - 1u])
            continue;
        uint slots[WIDTH], present = bvh8_children(nodes, shares, pair, scale, slots);
        global uint *to = wide + 64u * (size_t)bvh8_number(wide_ranks, pair, root);
        for (uint i = 0u; i < WIDTH; i++) {
            float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
            uint reference = 0u;
            if (i < present) {
                build_node_t child = nodes[slots[i]];
                reference = child.link & LEAF ? LEAF | ranks[child.first] : bvh8_number(wide_ranks, child.link, root);
                for (uint axis = 0u; axis < 3u; axis++) {
                    low[axis] = child.low[axis];
                    high[axis] = child.high[axis];
                }
            }
            for (uint axis = 0u; axis < 3u; axis++) {
                to[16u * axis + i] = as_uint(low[axis]);
                to[16u * axis + WIDTH + i] = as_uint(high[axis]);
            }
            to[6u * WIDTH + i] = reference;
            to[7u * WIDTH + i] = 0u;
        }
    }
}
