// Whether a ray stops at what it meets: an object may be invisible to some rays, and let others through by its opacity.

#include "accel/template.cl"
#include "lib/hash.cl"
#include "lib/opacity.cl"

#ifdef OPACITY
// One random number a ray, primitive and meeting, so that the order in which primitives are met does not matter.
static inline bool SHAPE_FUNCTION(stops)(const scene_t *scene, uint index, const ray_t *ray, const hit_t *candidate, uint meeting)
{
    uint primitive = index + SHAPE_FIRST;
    surface_t surface = SHAPE_FUNCTION(surface)(scene, index, ray, candidate);
    float u = unit_float(hash_combine(scene->ray_seed + meeting, primitive));
    return u < object_opacity(scene, scene->objects + scene->primitive_objects[primitive], &surface);
}
#endif

// May move `candidate` to where the ray, let through, meets the primitive again before t_max.
static inline bool SHAPE_FUNCTION(counts)(const scene_t *scene, uint index, const ray_t *ray, const SHAPE_FUNCTION(ray_t) *prepared, float t_max,
                                          hit_t *candidate)
{
    global const object_t *object = scene->objects + scene->primitive_objects[index + SHAPE_FIRST];
#ifdef VISIBILITY
    if ((object->flags & scene->ray_mask) != scene->ray_mask)
        return false;
#endif
#ifdef OPACITY
    if (object->flags & OBJECT_TRANSLUCENT) {
        if (SHAPE_FUNCTION(stops)(scene, index, ray, candidate, 0u))
            return true;
#if SHAPE_FUNCTION(meets_twice)
        return SHAPE_FUNCTION(intersect_again)(scene, index, ray, prepared, t_max, candidate)
            && SHAPE_FUNCTION(stops)(scene, index, ray, candidate, 1u);
#else
        return false;
#endif
    }
#endif
    return true;
}
