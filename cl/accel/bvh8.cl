// A BVH of eight children a node and eight triangles a leaf: one ray a work-item, its eight boxes or triangles in one vector each
// (Wald, Benthin & Boulos 2008, "Getting Rid of Packets"). For triangles only. lumiere/accel/bvh8.py says what is in the arrays.
//
// Vectors are dereferenced and compared with ?:, not through vload8, min and max, which are calls on some runtimes.

#include "accel/template.cl"
#include "accel/bvh8_node.cl"
#include "accel/bvh8_block.cl"

// A child on the stack: its distance above its number. It is fetched, since a ray that meets it is likely to come there.
static inline ulong SHAPE_FUNCTION(entry)(const scene_t *scene, uint child, float enter)
{
    bvh8_fetch(child & BVH8_LEAF ? SHAPE_BUFFER(blocks) + BVH8_BLOCK * (size_t)(child & ~BVH8_LEAF)
                                 : (global const float *)SHAPE_BUFFER(nodes) + 64 * (size_t)child);
    return ((ulong)as_uint(enter) << 32) | child;
}

// The triangle `index`, where its lane is in doubt. Seldom called, and never inlined, so that what is done all the time keeps its registers.
__attribute__((noinline)) static bool SHAPE_FUNCTION(decide)(const scene_t *scene, uint index, const ray_t *ray, float t_max, hit_t *hit)
{
    const SHAPE_FUNCTION(ray_t) prepared = SHAPE_FUNCTION(prepare)(ray);
    return SHAPE_FUNCTION(intersect)(scene, index, ray, &prepared, t_max, hit);
}

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
            global const uint *children = node + 48;
            bvh8_floats_t enter;
            ulong lanes = bvh8_enter(&wide, (global const float *)node, hit->t, &enter);
            if (lanes) {
                // The nearest stays at hand and the others are sorted on the stack; for any hit the order does not matter.
                uint lane = bvh8_first_lane(lanes);
                // Its number by itself, too: the next step waits for it, and for nothing else.
                current = children[lane];
                ulong next = SHAPE_FUNCTION(entry)(scene, current, enter.lane[lane]);
                while (lanes &= lanes - 1UL) {
                    lane = bvh8_first_lane(lanes);
                    ulong entry = SHAPE_FUNCTION(entry)(scene, children[lane], enter.lane[lane]);
                    bool closer = any_hit || entry < next;
                    ulong later = closer ? next : entry;
                    next = closer ? entry : next;
                    current = closer ? (uint)entry : current;
                    uint at = size++;
                    for (; !any_hit && at > before && stack[at - 1u] < later; at--)
                        stack[at] = stack[at - 1u];
                    stack[at] = later;
                }
                continue;
            }
        } else {
            global const float *block = SHAPE_BUFFER(blocks) + BVH8_BLOCK * (size_t)(current & ~BVH8_LEAF);
            bvh8_block_t test;
            VISIT_PRIMITIVES(scene, (bvh8_range(block) >> 28) + 1u);
            bvh8_block_test(&prepared, block, hit->t, &test);
            for (ulong lanes = test.met | test.doubt; lanes; lanes &= lanes - 1UL) {
                uint lane = bvh8_first_lane(lanes), range = bvh8_range(block);
                if (lane > range >> 28)
                    break;
                uint index = SHAPE_PRIMITIVE((range & 0x0fffffffu) + lane);
                hit_t candidate = {test.t.lane[lane], test.u.lane[lane], test.v.lane[lane], 0u};
                if (test.doubt & lanes & (0UL - lanes)) {
                    if (!SHAPE_FUNCTION(decide)(scene, index, ray, hit->t, &candidate))
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
