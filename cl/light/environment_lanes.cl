// The constant environment, sampled for sixteen paths.

#include "scene/lanes.cl"
#include "scene/sampler_lanes.cl"
#include "light/environment.cl"

static inline light_sample_t_lanes environment_sample_lanes(const scene_t *scene, const each_uint_t *index, float3_lanes reference, pair_t_lanes u)
{
    each_float_t r, g, b;
    ONE_BY_ONE
    for (uint lane = 0u; lane < LANES; lane++) {
        global const float *radiance = scene->environment_lights[index->lane[lane]].radiance;
        r.lane[lane] = radiance[0];
        g.lane[lane] = radiance[1];
        b.lane[lane] = radiance[2];
    }
    const float3_lanes w = square_to_sphere_lanes(float2_of_lanes(unit_float_lanes(u.x), unit_float_lanes(u.y)));
    return light_sample_new_lanes(w, float3_of_lanes(r.all, g.all, b.all), 0.5f * INV_TWO_PI, -1, 0);
}
