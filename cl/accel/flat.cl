// A plain list: every primitive is tested. Reads no buffer of its own.

#include "accel/template.cl"

static inline bool SHAPE_FUNCTION(nearest)(const scene_t *scene, const ray_t *ray, hit_t *hit)
{
    if (!ray_is_valid(ray))
        return false;
    SHAPE_FUNCTION(ray_t) prepared = SHAPE_FUNCTION(prepare)(ray);
    bool found = false;
    for (uint index = 0; index < SHAPE_COUNT; index++) {
        hit_t candidate;
        VISIT_PRIMITIVES(scene, 1u);
        if (SHAPE_FUNCTION(intersect)(scene, index, ray, &prepared, hit->t, &candidate) && SHAPE_ACCEPTS(index, hit->t)) {
            *hit = candidate;
            hit->primitive = index + SHAPE_FIRST;
            found = true;
        }
    }
    return found;
}

static inline bool SHAPE_FUNCTION(occluded)(const scene_t *scene, const ray_t *ray)
{
    if (!ray_is_valid(ray))
        return false;
    SHAPE_FUNCTION(ray_t) prepared = SHAPE_FUNCTION(prepare)(ray);
    for (uint index = 0; index < SHAPE_COUNT; index++) {
        hit_t candidate;
        VISIT_PRIMITIVES(scene, 1u);
        if (SHAPE_FUNCTION(intersect)(scene, index, ray, &prepared, ray->t_max, &candidate) && SHAPE_ACCEPTS(index, ray->t_max))
            return true;
    }
    return false;
}
