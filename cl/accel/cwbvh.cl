// A compressed BVH of eight children a node (Ylitie, Karras & Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
// BVHs"). Children lie in slots by octant, so that the order in which a ray visits them is that of their slots' numbers XOR the ray's octant.

#include "accel/cwbvh_node.cl"
#include "accel/template.cl"

// At most one entry a level, and no wide tree is deeper than its binary one (lumiere/accel/build.py, MAX_DEPTH).
#define CWBVH_STACK 48

// The nearest hit before hit->t, or with any_hit an arbitrary one.
static inline bool SHAPE_FUNCTION(traverse)(const scene_t *scene, const ray_t *ray, hit_t *hit, const bool any_hit)
{
    if (SHAPE_COUNT == 0u || !ray_is_valid(ray))
        return false;
    SHAPE_FUNCTION(ray_t) prepared = SHAPE_FUNCTION(prepare)(ray);
    cwbvh_ray_t wide = cwbvh_prepare(ray);
    global const uint4 *nodes = (global const uint4 *)SHAPE_BUFFER(nodes);

    // Siblings: the number of the first that is a node; from bit 24 on those yet to be visited; below, the slots that hold nodes. First the root.
    uint2 group = (uint2)(0u, CWBVH_FIRST_INNER << wide.octant);
    uint2 stack[CWBVH_STACK];
    uint size = 0u;
    bool found = false;
    for (;;) {
        uint met = 0u, first = 0u;
        while (met == 0u) {
            if (group.y < CWBVH_FIRST_INNER) {
                if (size == 0u)
                    return found;
                group = stack[--size];
            }
            uint bit = 31u - clz(group.y), slot = (bit - 24u) ^ wide.octant;
            group.y ^= 1u << bit;
            global const uint4 *node = nodes + 5u * (size_t)(group.x + popcount(group.y & ((1u << slot) - 1u)));
            if (group.y >= CWBVH_FIRST_INNER)
                stack[size++] = group;
            VISIT_NODE(scene);
            uint4 head = node[0], children = node[1];
            uint bits = cwbvh_test(&wide, node, head, children, hit->t);
            group = (uint2)(children.x, (bits & 0xff000000u) | head.w >> 24);
            met = bits & 0x00ffffffu;
            first = children.y;
        }
        for (; met != 0u; met &= met - 1u) {
            uint index = first + 31u - clz(met & (0u - met));
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
