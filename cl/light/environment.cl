// The constant environment: uniform over the sphere.

#include "lib/warp.cl"

static inline light_sample_t environment_sample(const scene_t *scene, uint index, float3 reference, uint2 u)
{
    const float3 w = square_to_sphere(float2_of(unit_float(u.x), unit_float(u.y)));
    return light_sample_new(w, load3(scene->environment_lights[index].radiance), 0.5f * INV_TWO_PI, 1, 0);
}

static inline float environment_pdf(const scene_t *scene, uint index, float3 w)
{
    return 0.5f * INV_TWO_PI;
}

static inline float3 environment_radiance(const scene_t *scene, uint index, float3 w)
{
    return load3(scene->environment_lights[index].radiance);
}
