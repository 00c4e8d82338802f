// The children of the wide nodes of lumiere/accel/cwbvh.py in the slots that suit where they lie (its by_octant), and the numbers of the nodes, of which
// siblings follow each other. Between the two kernels, `inner` and `leaf_primitives` are summed up over the wide nodes.

#include "accel/build/wide.cl"

// Binary nodes, as slots in `arranged`, 0 for none; how many of them are inner ones, and how many primitives the others hold.
KERNEL void arrange_cwbvh(global const build_node_t *nodes, global const uint *wide_ranks, global const uint *shares, const uint count, const uint span,
                          global uint *arranged, global uint *inner, global uint *leaf_primitives)
{
    uint begin = (uint)get_global_id(0) * span;
    if (begin >= count)
        return;
    for (uint pair = max(begin, 1u); pair < begin + min(span, count - begin); pair++) {
        if (wide_ranks[pair] == wide_ranks[pair - 1u])
            continue;
        uint slots[WIDTH], present = wide_children(nodes, shares, pair, slots), wide = wide_ranks[pair] - 1u, inner_here = 0u, primitives_here = 0u;
        float3 centres[WIDTH];
        float8 whole = box_nothing();
        for (uint i = 0u; i < present; i++) {
            float8 box = node_box(nodes + slots[i]);
            uint link = nodes[slots[i]].link;
            whole = box_join(whole, box);
            centres[i] = 0.25f * box_centre(box).s012;  // sums of three do not overflow
            inner_here += link & LEAF ? 0u : 1u;
            primitives_here += link & LEAF ? link & ~LEAF : 0u;
        }
        inner[wide] = inner_here;
        leaf_primitives[wide] = primitives_here;
        for (uint slot = 0u; slot < WIDTH; slot++)
            arranged[WIDTH * (size_t)wide + slot] = 0u;
        float3 centre = 0.25f * box_centre(whole).s012;
        uint placed = 0u, taken = 0u;
        for (uint round = 0u; round < present; round++) {
            float most = -INFINITY;
            uint child = 0u, at = 0u;
            for (uint i = 0u; i < present; i++) {
                float3 way = centres[i] - centre;
                for (uint slot = 0u; slot < WIDTH; slot++) {
                    float gain = (slot & 4u ? way.x : -way.x) + (slot & 2u ? way.y : -way.y) + (slot & 1u ? way.z : -way.z);
                    if (gain > most && !(placed >> i & 1u) && !(taken >> slot & 1u)) {
                        most = gain;
                        child = i;
                        at = slot;
                    }
                }
            }
            placed |= 1u << child;
            taken |= 1u << at;
            arranged[WIDTH * (size_t)wide + at] = slots[child];
        }
    }
}

KERNEL void number_cwbvh(global const build_node_t *nodes, global const uint *wide_ranks, global const uint *arranged, global const uint *inner_sums,
                         const uint count, const uint span, global uint *numbers)
{
    uint begin = (uint)get_global_id(0) * span;
    if (begin >= count)
        return;
    for (uint wide = begin; wide < begin + min(span, count - begin); wide++) {
        uint number = 1u + (wide > 0u ? inner_sums[wide - 1u] : 0u);
        for (uint slot = 0u; slot < WIDTH; slot++) {
            uint child = arranged[WIDTH * (size_t)wide + slot];
            if (child != 0u && !(nodes[child].link & LEAF))
                numbers[wide_ranks[nodes[child].link] - 1u] = number++;
        }
    }
}
