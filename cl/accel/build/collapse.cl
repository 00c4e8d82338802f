// Which binary nodes become children of wide nodes, for the least area of wide nodes in all (Ylitie et al. 2017, "Efficient Incoherent Ray Traversal on
// GPUs Through Compressed Wide BVHs", section 3.1), in two walks: `weigh_subtrees` and then, over what is above them, `weigh_top` sum up areas from the
// leaves; `widen_top` and then `widen_subtrees` choose from the root. What passes between is kept at a subtree's first primitive.

#include "accel/build/shares.cl"
#include "accel/build/tree.cl"

#define WIDTH 8u

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

// The areas of the node at `slot`, over primitives up to `end`; where `count <= small`, those that were kept.
static inline float8 collapse_weigh(global const build_node_t *nodes, uint slot, uint end, uint small, float scale, global const float8 *kept,
                                    global uint *shares)
{
    float8 left[MAX_DEPTH];
    float area[MAX_DEPTH];
    uint pair[MAX_DEPTH], ends[MAX_DEPTH];
    bool on_right[MAX_DEPTH];
    uint depth = 0u;
    for (;;) {
        float8 areas = (float8)(0.0f);
        global const build_node_t *node = nodes + slot;
        if (!(node->link & LEAF)) {
            if (end - node->first > small) {
                area[depth] = box_area(node_box(node), scale);
                pair[depth] = node->link;
                ends[depth] = end;
                on_right[depth] = false;
                slot = 2u * node->link;
                end = nodes[slot + 1u].first;
                depth++;
                continue;
            }
            areas = kept[node->first];
        }
        while (depth > 0u && on_right[depth - 1u]) {
            depth--;
            areas = collapse_join(left[depth], areas, area[depth], shares + pair[depth]);
        }
        if (depth == 0u)
            return areas;
        left[depth - 1u] = areas;
        on_right[depth - 1u] = true;
        end = ends[depth - 1u];
        slot = 2u * pair[depth - 1u] + 1u;
    }
}

// Marks the wide nodes of the subtree at `slot`, which may stand for `allowed` children, by their pairs. Keeps for nodes of no more than `small`
// primitives how many they may stand for.
static inline void collapse_widen(global const build_node_t *nodes, uint slot, uint end, uint allowed, uint small, global const uint *shares,
                                  global uint *wide, global float8 *kept)
{
    uint slots[MAX_DEPTH], ends[MAX_DEPTH], alloweds[MAX_DEPTH];
    uint waiting = 0u;
    for (;;) {
        global const build_node_t *node = nodes + slot;
        if (!(node->link & LEAF)) {
            uint pair = node->link;
            if (end - node->first > small) {
                uint share = share_of(shares[pair], allowed);
                if (share == 0u) {
                    wide[pair] = 1u;
                    allowed = WIDTH;
                    share = share_of(shares[pair], WIDTH);
                }
                slots[waiting] = 2u * pair + 1u;
                ends[waiting] = end;
                alloweds[waiting] = allowed - share;
                waiting++;
                slot = 2u * pair;
                end = nodes[2u * pair + 1u].first;
                allowed = share;
                continue;
            }
            kept[node->first] = (float8)((float)allowed);
        }
        if (waiting == 0u)
            return;
        waiting--;
        slot = slots[waiting];
        end = ends[waiting];
        allowed = alloweds[waiting];
    }
}

KERNEL void weigh_subtrees(global const subtree_t *roots, const uint root_count, global const build_node_t *nodes, global float8 *kept,
                           global uint *shares)
{
    uint root = (uint)get_global_id(0);
    if (root >= root_count)
        return;
    float scale = box_unit_scale(node_box(nodes));
    kept[roots[root].first] = collapse_weigh(nodes, roots[root].slot, roots[root].first + roots[root].count, 0u, scale, kept, shares);
}

KERNEL void weigh_top(const uint count, const uint small, global const build_node_t *nodes, global const float8 *kept, global uint *shares)
{
    if (count > small)
        collapse_weigh(nodes, 0u, count, small, box_unit_scale(node_box(nodes)), kept, shares);
}

KERNEL void widen_top(const uint count, const uint small, global const build_node_t *nodes, global float8 *kept, global const uint *shares,
                      global uint *wide)
{
    collapse_widen(nodes, 0u, count, 1u, small, shares, wide, kept);
}

KERNEL void widen_subtrees(global const subtree_t *roots, const uint root_count, global const build_node_t *nodes, global float8 *kept,
                           global const uint *shares, global uint *wide)
{
    uint root = (uint)get_global_id(0);
    if (root >= root_count)
        return;
    collapse_widen(nodes, roots[root].slot, roots[root].first + roots[root].count, (uint)kept[roots[root].first].s0, 0u, shares, wide, kept);
}
