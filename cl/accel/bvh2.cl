// A binary BVH, a node holding both children's boxes (Aila & Laine 2009, "Understanding the efficiency of ray traversal on GPUs").
// Reads nodes (three float4 each) and children (a uint2 each); lumiere/accel/bvh2.py says what is in them.

#include "accel/bvh2_stack.cl"
#include "accel/slab.cl"
#include "accel/template.cl"

// The nearest hit before hit->t, or with any_hit an arbitrary one.
static inline bool SHAPE_FUNCTION(traverse)(const scene_t *scene, const ray_t *ray, hit_t *hit, const bool any_hit)
{
    if (SHAPE_COUNT == 0u || !ray_is_valid(ray))
        return false;
    SHAPE_FUNCTION(ray_t) prepared = SHAPE_FUNCTION(prepare)(ray);
    slab_ray_t slab_ray = slab_prepare(ray);
    global const float4 *nodes = (global const float4 *)SHAPE_BUFFER(nodes);
    global const uint2 *children = (global const uint2 *)SHAPE_BUFFER(children);

    bvh2_stack_t stack;
    stack.size = 0;
    uint current = 0;
    bool found = false;
    for (;;) {
        while (!(current & BVH2_LEAF)) {
            float4 left_xy = nodes[3 * current], right_xy = nodes[3 * current + 1], z = nodes[3 * current + 2];
            uint2 child = children[current];
            VISIT_NODE(scene);
            float left = slab_enter(&slab_ray, left_xy.xy, left_xy.zw, z.xy, hit->t);
            float right = slab_enter(&slab_ray, right_xy.xy, right_xy.zw, z.zw, hit->t);
            bool left_first = left <= right;
            float near = left_first ? left : right, far = left_first ? right : left;
            if (far < INFINITY)
                bvh2_defer(&stack, left_first ? child.y : child.x, far);
            if (near < INFINITY)
                current = left_first ? child.x : child.y;
            else
                current = bvh2_resume(&stack, hit->t);
        }
        if (current == BVH2_DONE)
            return found;
        uint first = current & 0x0fffffffu, count = (current >> 28 & 7u) + 1u;
        for (uint place = first; place < first + count; place++) {
            uint index = SHAPE_PRIMITIVE(place);
            hit_t candidate;
            VISIT_PRIMITIVES(scene, 1u);
            if (SHAPE_FUNCTION(intersect)(scene, index, ray, &prepared, hit->t, &candidate) && SHAPE_ACCEPTS(index, hit->t)) {
                *hit = candidate;
                hit->primitive = index + SHAPE_FIRST;
                found = true;
                if (any_hit)
                    return true;
            }
        }
        current = bvh2_resume(&stack, hit->t);
    }
}

static inline bool SHAPE_FUNCTION(nearest)(const scene_t *scene, const ray_t *ray, hit_t *hit)
{
    return SHAPE_FUNCTION(traverse)(scene, ray, hit, false);
}

static inline bool SHAPE_FUNCTION(occluded)(const scene_t *scene, const ray_t *ray)
{
    hit_t hit;
    hit.t = ray->t_max;
    return SHAPE_FUNCTION(traverse)(scene, ray, &hit, true);
}
