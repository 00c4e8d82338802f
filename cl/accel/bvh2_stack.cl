// The children that a ray has yet to visit in a binary BVH, and where it enters them.

#include "accel/slab.cl"

#define BVH2_LEAF 0x80000000u
#define BVH2_DONE 0xffffffffu  // no reference: a leaf of 8 cannot begin at the last primitive number

// One child is deferred a level at most, and the builder makes no tree deeper than this (lumiere/accel/build.py, MAX_DEPTH).
#define BVH2_STACK 48

typedef struct {
    uint child[BVH2_STACK];
    float enter[BVH2_STACK];
    uint size;
} bvh2_stack_t;

static inline void bvh2_defer(bvh2_stack_t *stack, uint child, float enter)
{
    stack->child[stack->size] = child;
    stack->enter[stack->size] = enter;
    stack->size++;
}

// The child deferred last of those that do not by now lie behind the nearest hit.
static inline uint bvh2_resume(bvh2_stack_t *stack, float t_max)
{
    while (stack->size > 0) {
        stack->size--;
        if (stack->enter[stack->size] <= t_max * SLAB_MARGIN)
            return stack->child[stack->size];
    }
    return BVH2_DONE;
}
