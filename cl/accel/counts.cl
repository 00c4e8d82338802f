// Whether a ray stops at what it meets: an object may be invisible to some rays, and let others through by its opacity.

#include "accel/template.cl"
#include "lib/hash.cl"
#include "lib/opacity.cl"

static inline bool SHAPE_FUNCTION(counts)(const scene_t *scene, uint index, const ray_t *ray, const hit_t *candidate)
{
    uint primitive = index + SHAPE_FIRST;
    global const object_t *object = scene->objects + scene->primitive_objects[primitive];
#ifdef VISIBILITY
    if ((object->flags & scene->ray_mask) != scene->ray_mask)
        return false;
#endif
#ifdef OPACITY
    if (object->flags & OBJECT_TRANSLUCENT) {
        // One random number a ray and primitive, so that the order in which primitives are met does not matter.
        surface_t surface = SHAPE_FUNCTION(surface)(scene, index, ray, candidate);
        return unit_float(hash_combine(scene->ray_seed, primitive)) < object_opacity(scene, object, &surface);
    }
#endif
    return true;
}
