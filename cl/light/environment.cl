// The constant environment: uniform over the sphere.

#include "lib/circle.cl"

static inline light_sample_t environment_sample(const scene_t *scene, uint index, float3 reference, uint2 u)
{
    float z = 1.0f - 2.0f * unit_float(u.x);
    float r = sqrt(fmax(0.0f, 1.0f - z * z));
    return light_sample_new((float3)(r * circle_point(unit_float(u.y)), z), load3(scene->environment_lights[index].radiance), 0.5f * INV_TWO_PI, 1, 0);
}

static inline float environment_pdf(const scene_t *scene, uint index, float3 w)
{
    return 0.5f * INV_TWO_PI;
}

static inline float3 environment_radiance(const scene_t *scene, uint index, float3 w)
{
    return load3(scene->environment_lights[index].radiance);
}
