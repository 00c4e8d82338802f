// Which binary nodes become children of wide nodes, for the least area of wide nodes in all (Ylitie et al. 2017, "Efficient Incoherent Ray Traversal on
// GPUs Through Compressed Wide BVHs", section 3.1), in two walks: `weigh_subtrees` and then, for the large nodes, `weigh_level` from the last level up sum up
// areas from the leaves; `widen_level` from the root down and then `widen_subtrees` choose. What passes between is kept at a node's first primitive.

#include "accel/build/wide.cl"

// The least area of wide nodes in a subtree that stands for at most 1, …, 7 children, in lanes 0 to 6.
typedef union {
    float8 all;
    float lane[8];
} areas_t;

typedef union {
    int8 all;
    int lane[8];
} ways_t;

#define COLLAPSE_TRY(k, of_left, of_right)                \
    {                                                     \
        float8 sums = of_left + of_right;                 \
        best = sums < parted ? (int8)(k) : best;          \
        parted = sums < parted ? sums : parted;           \
    }

// A node's areas from its children's, and its shares.
static inline float8 collapse_join(float8 left_areas, float8 right_areas, float area, global uint *shares)
{
    // In lane j - 1: of the ways to part j children, k of them to the left, the best.
    float8 l = left_areas, r = right_areas, parted = (float8)(INFINITY), none = (float8)(INFINITY);
    int8 best = (int8)(0);
    COLLAPSE_TRY(1, l.s0, (float8)(INFINITY, r.s0123, r.s456));
    COLLAPSE_TRY(2, l.s1, (float8)(none.s01, r.s0123, r.s45));
    COLLAPSE_TRY(3, l.s2, (float8)(none.s012, r.s0123, r.s4));
    COLLAPSE_TRY(4, l.s3, (float8)(none.s0123, r.s0123));
    COLLAPSE_TRY(5, l.s4, (float8)(none.s0123, none.s0, r.s012));
    COLLAPSE_TRY(6, l.s5, (float8)(none.s0123, none.s01, r.s01));
    COLLAPSE_TRY(7, l.s6, (float8)(none.s0123, none.s012, r.s0));
    areas_t result, by_count;
    ways_t ways;
    by_count.all = parted;
    ways.all = best;
    result.lane[0] = area + by_count.lane[WIDTH - 1u];
    result.lane[7] = 0.0f;
    uint way = 0u, packed = (uint)ways.lane[WIDTH - 1u] << 18;
    for (uint j = 2u; j < WIDTH; j++) {
        bool fewer = result.lane[j - 2u] <= by_count.lane[j - 1u];
        result.lane[j - 1u] = fewer ? result.lane[j - 2u] : by_count.lane[j - 1u];
        way = fewer ? way : (uint)ways.lane[j - 1u];
        packed |= way << 3u * (j - 2u);
    }
    *shares = packed;
    return result.all;
}

// The areas of the node at `slot`.
static inline float8 collapse_weigh(global const build_node_t *nodes, uint slot, float scale, global uint *shares)
{
    float8 left[MAX_DEPTH];
    float area[MAX_DEPTH];
    uint pair[MAX_DEPTH];
    bool on_right[MAX_DEPTH];
    uint depth = 0u;
    for (;;) {
        global const build_node_t *node = nodes + slot;
        if (!(node->link & LEAF)) {
            area[depth] = box_area(node_box(node), scale);
            pair[depth] = node->link;
            on_right[depth] = false;
            slot = 2u * node->link;
            depth++;
            continue;
        }
        float8 areas = (float8)(0.0f);
        while (depth > 0u && on_right[depth - 1u]) {
            depth--;
            areas = collapse_join(left[depth], areas, area[depth], shares + pair[depth]);
        }
        if (depth == 0u)
            return areas;
        left[depth - 1u] = areas;
        on_right[depth - 1u] = true;
        slot = 2u * pair[depth - 1u] + 1u;
    }
}

// Of the children that the node above a pair may stand for, how many its left child should; `allowed` then says how many both should. Marks the pair
// where a wide node begins with it.
static inline uint collapse_open(uint pair, uint *allowed, global const uint *shares, global uint *wide)
{
    uint share = share_of(shares[pair], *allowed);
    if (share == 0u) {
        wide[pair] = 1u;
        *allowed = WIDTH;
        share = share_of(shares[pair], WIDTH);
    }
    return share;
}

// Marks the wide nodes of the subtree at `slot`, which may stand for `allowed` children.
static inline void collapse_widen(global const build_node_t *nodes, uint slot, uint allowed, global const uint *shares, global uint *wide)
{
    uint slots[MAX_DEPTH], alloweds[MAX_DEPTH];
    uint waiting = 0u;
    for (;;) {
        uint pair = nodes[slot].link;
        if (!(pair & LEAF)) {
            uint share = collapse_open(pair, &allowed, shares, wide);
            slots[waiting] = 2u * pair + 1u;
            alloweds[waiting] = allowed - share;
            waiting++;
            slot = 2u * pair;
            allowed = share;
            continue;
        }
        if (waiting == 0u)
            return;
        waiting--;
        slot = slots[waiting];
        allowed = alloweds[waiting];
    }
}

KERNEL void weigh_subtrees(global const subtree_t *roots, const uint root_count, global const build_node_t *nodes, global float8 *kept,
                           global uint *shares)
{
    uint root = (uint)get_global_id(0);
    if (root >= root_count)
        return;
    kept[roots[root].first] = collapse_weigh(nodes, roots[root].slot, box_unit_scale(node_box(nodes)), shares);
}

KERNEL void weigh_level(global const counters_t *counters, const uint level, global const plane_t *planes, global const build_node_t *nodes,
                        global float8 *kept, global uint *shares)
{
    uint i = (uint)get_global_id(0);
    if (i >= counters->open[level])
        return;
    uint pair = planes[level * counters->room + i].middle;
    float8 left = node_box(nodes + 2u * pair), right = node_box(nodes + 2u * pair + 1u);
    uint first = nodes[2u * pair].first;
    kept[first] = collapse_join(kept[first], kept[nodes[2u * pair + 1u].first], box_area(box_join(left, right), box_unit_scale(node_box(nodes))),
                                shares + pair);
}

KERNEL void widen_level(global const counters_t *counters, const uint level, global const plane_t *planes, global const build_node_t *nodes,
                        global float8 *kept, global const uint *shares, global uint *wide)
{
    uint i = (uint)get_global_id(0);
    if (i >= counters->open[level])
        return;
    uint pair = planes[level * counters->room + i].middle, first = nodes[2u * pair].first;
    uint allowed = level > 0u ? (uint)kept[first].s0 : 1u, share = collapse_open(pair, &allowed, shares, wide);
    kept[first] = (float8)((float)share);
    kept[nodes[2u * pair + 1u].first] = (float8)((float)(allowed - share));
}

// `allowed`: for the root, where it is not large; else 0.
KERNEL void widen_subtrees(global const subtree_t *roots, const uint root_count, const uint allowed, global const build_node_t *nodes,
                           global const float8 *kept, global const uint *shares, global uint *wide)
{
    uint root = (uint)get_global_id(0);
    if (root >= root_count)
        return;
    collapse_widen(nodes, roots[root].slot, allowed ? allowed : (uint)kept[roots[root].first].s0, shares, wide);
}
