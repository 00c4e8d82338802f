// A BVH of eight children a node and eight triangles a leaf: one ray a work-item, its eight boxes or triangles in one vector each
// (Wald, Benthin & Boulos 2008, "Getting Rid of Packets"). For triangles only. lumiere/accel/bvh8.py says what is in the arrays.
//
// Vectors are dereferenced and compared with ?:, not through vload8, min and max, which are calls on some runtimes.

#include "accel/template.cl"
#include "accel/bvh8_node.cl"
#include "accel/bvh8_block.cl"

// The nearest hit before hit->t, or with any_hit an arbitrary one.
static inline bool SHAPE_FUNCTION(traverse)(const scene_t *scene, const ray_t *ray, hit_t *hit, const bool any_hit)
{
    if (SHAPE_COUNT == 0u || !ray_is_valid(ray))
        return false;
    SHAPE_FUNCTION(ray_t) prepared = SHAPE_FUNCTION(prepare)(ray);
    bvh8_ray_t wide = bvh8_prepare(ray);
    ulong stack[BVH8_STACK];
    uint size = 0u, current = 0u;
    bool found = false;
    for (;;) {
        if (!(current & BVH8_LEAF)) {
            uint before = size;
            VISIT_NODE(scene);
            global const uint *node = SHAPE_BUFFER(nodes) + 64 * (size_t)current;
            bvh8_uints_t children;
            children.all = *(global const uint8 *)(node + 48);  // before the boxes are tested, so that it is not waited for behind them
            bvh8_floats_t enter;
            ulong lanes = bvh8_enter(&wide, (global const float *)node, hit->t, &enter);
            while (lanes) {
                uint lane = bvh8_first_lane(lanes);
                lanes &= lanes - 1UL;
                ulong entry = ((ulong)as_uint(enter.lane[lane]) << 32) | children.lane[lane];
                uint at = size++;
                // The nearest on top; for any hit the order does not matter.
                for (; !any_hit && at > before && stack[at - 1u] < entry; at--)
                    stack[at] = stack[at - 1u];
                stack[at] = entry;
            }
        } else {
            uint block = current & ~BVH8_LEAF;
            bvh8_block_t test;
            VISIT_PRIMITIVES(scene, (SHAPE_BUFFER(ranges)[block] >> 28) + 1u);
            bvh8_block_test(&prepared, SHAPE_BUFFER(blocks) + 72 * (size_t)block, hit->t, &test);
            for (ulong lanes = test.met | test.doubt; lanes; lanes &= lanes - 1UL) {
                uint lane = bvh8_first_lane(lanes), range = SHAPE_BUFFER(ranges)[block];
                if (lane > range >> 28)
                    break;
                uint index = SHAPE_PRIMITIVE((range & 0x0fffffffu) + lane);
                hit_t candidate = {test.t.lane[lane], test.u.lane[lane], test.v.lane[lane], 0u};
                if (test.doubt & lanes & (0UL - lanes)) {
                    if (!SHAPE_FUNCTION(intersect)(scene, index, ray, &prepared, hit->t, &candidate))
                        continue;
                } else if (!(candidate.t < hit->t)) {
                    continue;
                }
                if (!SHAPE_ACCEPTS(index, hit->t))
                    continue;
                *hit = candidate;
                hit->primitive = index + SHAPE_FIRST;
                found = true;
                if (any_hit)
                    return true;
            }
        }
        do {
            if (size == 0u)
                return found;
            size--;
        } while (!(as_float((uint)(stack[size] >> 32)) <= hit->t * SLAB_MARGIN));
        current = (uint)stack[size];
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
