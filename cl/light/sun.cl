// Directional lights with an angle: a disk of constant radiance in the sky, sampled uniformly over its solid angle.

#include "lib/circle.cl"

static inline light_sample_t sun_sample(const scene_t *scene, uint index, float3 reference, uint2 u)
{
    global const sun_light_t *light = scene->sun_lights + index;
    float one_minus_cos = unit_float(u.x) * light->one_minus_cos;
    float sine = sqrt(one_minus_cos * (2.0f - one_minus_cos));
    frame_t frame = frame_about(-load3(light->direction));
    float3 w = frame_to_world(&frame, (float3)(sine * circle_point(unit_float(u.y)), 1.0f - one_minus_cos));
    return light_sample_new(w, load3(light->radiance), INV_TWO_PI / light->one_minus_cos, 1, 0);
}

static inline float sun_pdf(const scene_t *scene, uint index, float3 w)
{
    return INV_TWO_PI / scene->sun_lights[index].one_minus_cos;
}

// |w + d|² / 2 = 1 − cos of the angle between w and −d, without cancellation.
static inline float3 sun_radiance(const scene_t *scene, uint index, float3 w)
{
    global const sun_light_t *light = scene->sun_lights + index;
    float3 away = w + load3(light->direction);
    return 0.5f * dot(away, away) <= light->one_minus_cos ? load3(light->radiance) : (float3)(0.0f);
}
