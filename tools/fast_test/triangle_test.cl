// In place of shape/triangle_test.cl, to measure what the watertight test costs (tools/benchmark_rays.py): rays as they are, and the helpers that
// shape/triangle.cl wants. Nothing is in doubt for bvh8_block.cl beside this, so that triangle_intersect is never called there.

#include "lib/ray.cl"

typedef struct {
    float3 o;
    float3 d;
} triangle_ray_t;

static inline triangle_ray_t triangle_prepare(const ray_t *ray)
{
    triangle_ray_t prepared = {ray->o, ray->d};
    return prepared;
}

static inline float triangle_unit_scale(float size)
{
    return 1.0f;
}

static inline float triangle_largest(float3 v)
{
    v = fabs(v);
    return fmax(v.x, fmax(v.y, v.z));
}

static inline bool triangle_intersect(const scene_t *scene, uint index, const ray_t *ray, const triangle_ray_t *prepared, float t_max,
                                      hit_t *hit)
{
    return false;
}
