// Sampling a light for each of sixteen paths. Kinds of lights that have no form for lanes are sampled path by path.

#include "lib/lights.cl"
#include "scene/lanes.cl"
#include "scene/lights_lanes.cl"
#include "scene/sampler_lanes.cl"

#ifdef LIGHTS_ONE_BY_ONE
// Light samples that are written one by one.
typedef struct {
    each_float_t target_x, target_y, target_z, radiance_x, radiance_y, radiance_z, pdf;
    each_int_t infinite, delta;
} each_light_sample_t;

static inline each_light_sample_t each_light_sample(const light_sample_t_lanes *s)
{
    const each_light_sample_t each = {{s->target.x}, {s->target.y}, {s->target.z}, {s->radiance.x}, {s->radiance.y}, {s->radiance.z}, {s->pdf},
                                      {s->infinite}, {s->delta}};
    return each;
}

static inline void put_light_sample(each_light_sample_t *each, uint lane, light_sample_t s)
{
    each->target_x.lane[lane] = s.target.x;
    each->target_y.lane[lane] = s.target.y;
    each->target_z.lane[lane] = s.target.z;
    each->radiance_x.lane[lane] = s.radiance.x;
    each->radiance_y.lane[lane] = s.radiance.y;
    each->radiance_z.lane[lane] = s.radiance.z;
    each->pdf.lane[lane] = s.pdf;
    each->infinite.lane[lane] = s.infinite ? -1 : 0;
    each->delta.lane[lane] = s.delta ? -1 : 0;
}

static inline light_sample_t_lanes all_light_samples(const each_light_sample_t *each)
{
    const light_sample_t_lanes s = {{each->target_x.all, each->target_y.all, each->target_z.all},
                                    {each->radiance_x.all, each->radiance_y.all, each->radiance_z.all},
                                    each->pdf.all, each->infinite.all, each->delta.all};
    return s;
}
#endif

static inline light_sample_t_lanes select_light_samples(int16 mask, const light_sample_t_lanes *yes, const light_sample_t_lanes *no)
{
    const light_sample_t_lanes s = {select_lanes(mask, yes->target, no->target), select_lanes(mask, yes->radiance, no->radiance),
                                    mask ? yes->pdf : no->pdf, mask ? yes->infinite : no->infinite, mask ? yes->delta : no->delta};
    return s;
}

// For the lanes that are `wanted`, as light_sample (lib/lights.cl).
static inline light_sample_t_lanes light_sample_lanes(const scene_t *scene, int16 wanted, float3_lanes reference, pair_t_lanes u)
{
    each_uint_t x = {u.x}, index = {0u}, rest;
    each_float_t probability;
    // As discrete_find: each step's entries are fetched together.
    for (uint left = scene->render->light_count; left > 1u; left -= left / 2u)
        for (uint lane = 0u; lane < LANES; lane++)
            index.lane[lane] += scene->light_cdf[index.lane[lane] + left / 2u - 1u] < x.lane[lane] ? left / 2u : 0u;
    for (uint lane = 0u; lane < LANES; lane++) {
        probability.lane[lane] = discrete_probability(scene->light_cdf, index.lane[lane]);
        rest.lane[lane] = discrete_rest(scene->light_cdf, index.lane[lane], x.lane[lane]);
    }
    u.x = rest.all;
    const float16 none = 0.0f;
    light_sample_t_lanes s = light_sample_new_lanes(reference, float3_of_lanes(none, none, none), none, 0, 0);
#define SAMPLE_IN_LANES(first, count, sample) \
    { \
        each_uint_t which = {index.all - first}; \
        const int16 chosen = wanted & (which.all < count); \
        if (any_lane(chosen)) { \
            which.all = chosen ? which.all : 0u; \
            const light_sample_t_lanes these = sample(scene, &which, reference, u); \
            s = select_light_samples(chosen, &these, &s); \
        } \
    }
#ifdef EMITTERS_IN_LANES
    SAMPLE_IN_LANES(0u, scene->render->emitter_count, emitter_sample_lanes)
#endif
#define SAMPLE_LIGHT_LANES(NAME) SAMPLE_IN_LANES(scene->render->NAME##_light_first, scene->render->NAME##_light_count, NAME##_sample_lanes)
    FOR_EACH_LIGHT_IN_LANES(SAMPLE_LIGHT_LANES)
#ifdef LIGHTS_ONE_BY_ONE
    const each_uint_t rest_x = {u.x}, rest_y = {u.y};
    each_light_sample_t each = each_light_sample(&s);
    const each_int_t waiting = {wanted};
    for (uint lane = 0u; lane < LANES; lane++) {
        if (!waiting.lane[lane])
            continue;
#if defined(EMITTERS) && !defined(EMITTERS_IN_LANES)
        if (index.lane[lane] < scene->render->emitter_count)
            put_light_sample(&each, lane, emitter_sample(scene, index.lane[lane], lane_of(&reference, lane), (uint2)(rest_x.lane[lane], rest_y.lane[lane])));
#endif
#define SAMPLE_LIGHT_ALONE(NAME) \
        if (index.lane[lane] - scene->render->NAME##_light_first < scene->render->NAME##_light_count) \
            put_light_sample(&each, lane, NAME##_sample(scene, index.lane[lane] - scene->render->NAME##_light_first, lane_of(&reference, lane), \
                                                        (uint2)(rest_x.lane[lane], rest_y.lane[lane])));
        FOR_EACH_LIGHT_ALONE(SAMPLE_LIGHT_ALONE)
    }
    s = all_light_samples(&each);
#endif
    s.pdf *= probability.all;
    return s;
}
