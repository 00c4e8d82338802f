// The arrays of lumiere/accel/bvh2.py, a pair of nodes at a time. A node's number is that of a walk that goes left first: all that split up to
// its first primitive come before it, and those above it that split after.

#include "accel/build/tree.cl"

static inline uint bvh2_number(global const uint *ranks, global const uchar *turns, uint first, uint pair)
{
    return ranks[first] + turns[pair] - 1u;
}

static inline uint bvh2_reference(global const build_node_t *node, global const uint *ranks, global const uchar *turns)
{
    if (node->link & LEAF)
        return LEAF | ((node->link & ~LEAF) - 1u) << 28 | node->first;
    return bvh2_number(ranks, turns, node->first, node->link);
}

KERNEL void encode_bvh2(global const build_node_t *nodes, global const uchar *turns, global const uint *ranks, const uint count, const uint span,
                        global float *planes, global uint *children)
{
    uint begin = (uint)get_global_id(0) * span;
    if (begin >= count)
        return;
    for (uint pair = max(begin, 1u); pair < begin + min(span, count - begin); pair++) {
        if (turns[pair] == 0u)
            continue;
        build_node_t left = nodes[2u * pair], right = nodes[2u * pair + 1u];
        uint number = bvh2_number(ranks, turns, left.first, pair);
        global float *to = planes + 12u * (size_t)number;
        vstore4((float4)(left.low[0], left.high[0], left.low[1], left.high[1]), 0, to);
        vstore4((float4)(right.low[0], right.high[0], right.low[1], right.high[1]), 1, to);
        vstore4((float4)(left.low[2], left.high[2], right.low[2], right.high[2]), 2, to);
        children[2u * (size_t)number] = bvh2_reference(nodes + 2u * pair, ranks, turns);
        children[2u * (size_t)number + 1u] = bvh2_reference(nodes + 2u * pair + 1u, ranks, turns);
    }
}
