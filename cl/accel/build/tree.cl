// The tree in the making. Its nodes lie in pairs, the children of pair p at 2 p and 2 p + 1, the root at 0. A large node that splits the primitives' order
// at `middle` has its children there; the pairs of a subtree that one work-item builds follow its first primitive. So no two are in one place, nobody
// waits for a number, and the tree does not depend on what was made first.

#include "accel/build/primitive.cl"

#define LEAF 0x80000000u

static inline void node_store(global build_node_t *nodes, uint slot, float8 box, uint first, uint link)
{
    build_node_t node = {{box.s0, box.s1, box.s2}, first, {-box.s4, -box.s5, -box.s6}, link};
    nodes[slot] = node;
}

static inline float8 node_box(global const build_node_t *node)
{
    return (float8)(node->low[0], node->low[1], node->low[2], 0.0f, -node->high[0], -node->high[1], -node->high[2], 0.0f);
}
