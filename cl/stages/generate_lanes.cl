// generate, for sixteen neighbouring slots at once: the same steps as in stages/generate.cl, in vectors. Takes its place on CPUs, for kinds of cameras
// that are written for lanes (lumiere/wavefront/source.py).
//
// From: the idle slots. To: extend.
// Also forgets the shadow rays of the last round's stages, and counts them.

#include "lib/film.cl"
#include "lib/filter.cl"
#include "lib/lanes.cl"
#include "lib/path.cl"
#include "lib/queue.cl"
#include "lib/samples.cl"
#include "lib/sampler.cl"
#include "scene/sampler_lanes.cl"
#include "scene/lanes.cl"

// Sixteen samples of the batch: which they are, and the pixels and samples of those that they stand for.
typedef struct {
    each_uint_t sample, x, y, index;
} film_samples_t;

// Numbers the lanes that are `wanted` from *next on. Neighbours are samples of one pixel, mostly: where they are, there is nothing to divide.
static inline film_samples_t film_samples(const scene_t *scene, int16 wanted, uint *next)
{
    const each_int_t taken = {wanted};
    film_samples_t s = {{0u}, {0u}, {0u}, {0u}};
    film_sample_t at = {0u, 0u, 0u};
    uint left = 0u;  // samples of the pixel after this one
    for (uint lane = 0u; lane < LANES; lane++) {
        if (!taken.lane[lane])
            continue;
        if (left == 0u) {
            at = film_sample(scene, *next);
            left = scene->batch->samples_a_pixel - *next % scene->batch->samples_a_pixel;
        } else
            at.index++;
        left--;
        s.sample.lane[lane] = *next;
        s.x.lane[lane] = at.x;
        s.y.lane[lane] = at.y;
        s.index.lane[lane] = at.index;
        (*next)++;
    }
    return s;
}

// Where in its pixel each path begins, in pixels from the middle, and its weight.
static inline float2_lanes film_offsets(const scene_t *scene, pair_t_lanes u, float16 *weight)
{
    each_float_t x = {unit_float_lanes(u.x)}, y = {unit_float_lanes(u.y)};
#ifdef FILTER_TABLE
    each_float_t weights;
    for (uint lane = 0u; lane < LANES; lane++) {
        const float2 fx = filter_sample(scene, x.lane[lane]), fy = filter_sample(scene, y.lane[lane]);
        x.lane[lane] = fx.x;
        y.lane[lane] = fy.x;
        weights.lane[lane] = fx.y * fy.y;
    }
    *weight = weights.all;
#else
    x.all = (2.0f * x.all - 1.0f) * scene->render->filter_radius;
    y.all = (2.0f * y.all - 1.0f) * scene->render->filter_radius;
    *weight = 1.0f;
#endif
    const float2_lanes offset = {x.all, y.all};
    return offset;
}

// Starts the samples from *next on in those of the sixteen slots that are `wanted`.
static inline void start_paths(const scene_t *scene, const path_t *path, const samples_t *samples, int16 wanted, uint first, uint *next)
{
    for (uint channel = 0u; channel < CHANNEL_COUNT; ++channel)
        for (uint i = 0u; i < count_lanes(wanted); i++)
            sample_set(samples, channel, *next + i, 0.0f);
    const film_samples_t at = film_samples(scene, wanted, next);
    const uint16 seed = hash_combine_lanes(hash_combine_lanes(scene->render->seed, at.x.all), at.y.all);
    const sequence_t_lanes sampler = {seed, at.index.all};
    float16 weight;
    const float2_lanes offset = film_offsets(scene, sample_2d_lanes(&sampler, DIMENSION_FILM), &weight);
    float2_lanes lens = {0.0f, 0.0f};
#ifdef CAMERA_LENS
    const pair_t_lanes u = sample_2d_lanes(&sampler, DIMENSION_LENS);
    lens = float2_of_lanes(unit_float_lanes(u.x), unit_float_lanes(u.y));
#endif
    float3_lanes origin, direction;
    camera_ray_lanes(scene->camera, film_point_lanes(scene->render, at.x.all, at.y.all, offset), lens, &origin, &direction);
    origin = add3_lanes(camera_to_world_lanes(scene->camera, origin), camera_position_lanes(scene->camera));
    path_set_sample_lanes(path, first, wanted, at.sample.all);
    path_set_depth_lanes(path, first, wanted, 0u);
    path_set_seed_lanes(path, first, wanted, seed);
    path_set_index_lanes(path, first, wanted, at.index.all);
    path_set_origin_lanes(path, first, wanted, origin);
    path_set_direction_lanes(path, first, wanted, unit3_lanes(camera_to_world_lanes(scene->camera, direction)));
    path_set_throughput_lanes(path, first, wanted, float3_of_lanes(weight, weight, weight));
#ifdef PATH_BSDF_PDF
    path_set_bsdf_pdf_lanes(path, first, wanted, 0.0f);
#endif
#ifdef PATH_ETA_SCALE
    path_set_eta_scale_lanes(path, first, wanted, 1.0f);
#endif
}

// A work-item does the slots of a group: a census, by which the idle ones get samples, and those that live and those that traced a shadow ray are counted.
kernel __attribute__((reqd_work_group_size(1, 1, 1))) UNVECTORIZED void generate(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    const uint begin = (uint)get_global_id(0) * WORK_GROUP_SIZE, end = begin + WORK_GROUP_SIZE;
    if (begin == 0u)
        counters[QUEUE_EXTEND_0 + (1u - parity)] = 0u;
    uint idle = 0u, connected = 0u;
    for (uint first = begin; first < end; first += LANES) {
        const int16 traced = queue_holds_connect_lanes(&queues, first);
        idle += count_lanes(queue_holds_lanes(&queues, QUEUE_IDLE_0, first));
        connected += count_lanes(traced);
        store_uint_lanes(queues.connects + first, traced, 0u);
    }
    const uint count = scene.batch->sample_count;
    uint next = idle > 0u ? atomic_add(counters + COUNTER_NEXT_SAMPLE, idle) : count;
    uint started = next < count ? min(idle, count - next) : 0u;
    const uint busy = WORK_GROUP_SIZE - idle + started;
    if (busy > 0u)
        atomic_add(counters + QUEUE_EXTEND_0 + parity, busy);
    if (connected > 0u)
        atomic_add(counters + COUNTER_SHADOW_RAYS, connected);
    for (uint first = begin; first < end && started > 0u; first += LANES) {
        each_int_t wanted = {queue_holds_lanes(&queues, QUEUE_IDLE_0, first)};
        for (uint lane = 0u; lane < LANES; lane++) {
            wanted.lane[lane] &= started > 0u ? -1 : 0;
            started -= wanted.lane[lane] ? 1u : 0u;
        }
        if (!any_lane(wanted.all))
            continue;
        start_paths(&scene, &path, &samples, wanted.all, first, &next);
        queue_push_lanes(&queues, wanted.all, QUEUE_EXTEND_0, first);
    }
}
