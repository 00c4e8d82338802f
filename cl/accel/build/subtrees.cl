// Subtrees of few primitives, a work-item each, from their roots to the leaves. The smaller child of a node comes first, so that few wait. The primitives
// of a node are in the one or the other buffer, by its level.

#include "accel/build/histogram.cl"
#include "accel/build/small.cl"
#include "accel/build/tree.cl"

typedef struct {
    float8 box;
    float8 centres;
    uint slot, first, count, turns;
} pending_t;

static inline split_t subtree_split(const pending_t *node, const grid_t *grid, uint bins, global const float8 *own, uint largest, pending_t *left,
                                    pending_t *right)
{
    float8 boxes[3u * BINS];
    uint counts[3u * BINS];
    histogram_fill(boxes, counts, own, node->count, grid, bins);
    split_t split = {INFINITY, 0u, NO_PLANE};
    float scale = box_unit_scale(node->box);
    ROLLED for (uint axis = 0u; axis < 3u; axis++)
        split_sweep(&split, axis, boxes + axis * bins, counts + axis * bins, bins, node->count, largest, scale);
    if (split.last != NO_PLANE) {
        left->box = right->box = box_nothing();
        left->count = 0u;
        ROLLED for (uint i = 0u; i < bins; i++) {
            float8 box = boxes[split.axis * bins + i];
            if (i <= split.last) {
                left->box = box_join(left->box, box);
                left->count += counts[split.axis * bins + i];
            } else {
                right->box = box_join(right->box, box);
            }
        }
    }
    return split;
}

// Is a leaf as cheap? A step of traversal costs as much as a block.
static inline bool subtree_ends(const pending_t *node, const split_t *split)
{
    float area = box_area(node->box, box_unit_scale(node->box));
    return node->count <= MAX_LEAF_SIZE && !(area + split->cost < (float)blocks_of(node->count) * area);
}

// Parts a node's primitives by a plane. The sides' boxes are known.
static inline void subtree_part(const split_t *split, const grid_t *grid, uint bins, global const float8 *own, uint count, global float8 *parted,
                                pending_t *left, pending_t *right)
{
    uint to_left = 0u, to_right = left->count;
    left->centres = right->centres = box_nothing();
    for (uint i = 0u; i < count; i++) {
        float8 box = own[i], centre = box_centre(box);
        bool goes_left = grid_bin(grid, bins, split->axis, centre) <= split->last;
        parted[goes_left ? to_left : to_right] = box;
        to_left += goes_left;
        to_right += !goes_left;
        left->centres = box_join(left->centres, goes_left ? centre : box_nothing());
        right->centres = box_join(right->centres, goes_left ? box_nothing() : centre);
    }
}

// Parts a node's primitives by their places: bit i of `sides`, or without any the first half goes left.
static inline void subtree_deal(uint sides, global const float8 *own, uint count, global float8 *parted, pending_t *left, pending_t *right)
{
    left->count = sides ? popcount(sides) : (count + 1u) / 2u;
    left->box = left->centres = right->box = right->centres = box_nothing();
    uint to_left = 0u, to_right = left->count;
    for (uint i = 0u; i < count; i++) {
        float8 box = own[i];
        bool goes_left = sides ? (sides >> i & 1u) != 0u : i < left->count;
        pending_t *side = goes_left ? left : right;
        side->box = box_join(side->box, box);
        side->centres = box_join(side->centres, box_centre(box));
        parted[goes_left ? to_left++ : to_right++] = box;
    }
}

KERNEL void subtrees(global const subtree_t *roots, const uint root_count, global float8 *even, global float8 *odd, global build_node_t *nodes,
                     global uchar *turns, global uint *marks, global uint *order)
{
    uint root = (uint)get_global_id(0);
    if (root >= root_count)
        return;
    pending_t pending[SUBTREE_STACK], node;
    uint levels[SUBTREE_STACK], waiting = 0u, pair = roots[root].first, level = roots[root].level;
    node.slot = roots[root].slot;
    node.first = roots[root].first;
    node.count = roots[root].count;
    node.turns = roots[root].turns;
    node.box = node.centres = box_nothing();
    for (uint i = node.first; i < node.first + node.count; i++) {
        float8 box = (level % 2u ? odd : even)[i];
        node.box = box_join(node.box, box);
        node.centres = box_join(node.centres, box_centre(box));
    }
    for (;;) {
        global float8 *own = (level % 2u ? odd : even) + node.first, *parted = (level % 2u ? even : odd) + node.first;
        split_t split = {INFINITY, 0u, NO_PLANE};
        const uint bins = node.count > FEW ? BINS : BINS / 2u;
        grid_t grid = grid_over(node.centres, bins);
        uint sides = 0u;
        pending_t left, right;
        if (node.count > SMALL && node.count > BLOCK)
            split = subtree_split(&node, &grid, bins, own, largest_child(level), &left, &right);
        else if (node.count > BLOCK)
            split = small_split(own, node.count, largest_child(level), box_unit_scale(node.box), &sides);
        if (subtree_ends(&node, &split)) {
            node_store(nodes, node.slot, node.box, node.first, LEAF | node.count);
            for (uint i = 0u; i < node.count; i++)
                order[node.first + i] = primitive_number(own[i]);
            if (waiting == 0u)
                return;
            node = pending[--waiting];
            level = levels[waiting];
            continue;
        }
        if (sides != 0u || split.last == NO_PLANE)
            subtree_deal(sides, own, node.count, parted, &left, &right);
        else
            subtree_part(&split, &grid, bins, own, node.count, parted, &left, &right);
        pair++;
        node_store(nodes, node.slot, node.box, node.first, pair);
        turns[pair] = (uchar)(node.turns + 1u);
        left.slot = 2u * pair;
        left.first = node.first;
        left.turns = node.turns + 1u;
        right.slot = 2u * pair + 1u;
        right.first = node.first + left.count;
        right.count = node.count - left.count;
        right.turns = node.turns;
        marks[right.first] = 1u;
        level++;
        levels[waiting] = level;
        bool left_waits = left.count > right.count;
        pending[waiting++] = left_waits ? left : right;
        node = left_waits ? right : left;
    }
}
