// generate, for sixteen paths at once: the same steps as in stages/generate.cl, in vectors. Takes its place on CPUs, for kinds of cameras
// that are written for lanes (lumiere/wavefront/lanes.py).
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

// Samples of the batch: the pixels and samples of those that they stand for.
typedef struct {
    each_uint_t x, y, index;
} film_samples_t;

// Of `count` samples from `first` on. Neighbours are samples of one pixel, mostly: where they are, there is nothing to divide.
static inline film_samples_t film_samples(const scene_t *scene, uint first, uint count)
{
    film_samples_t s = {{0u}, {0u}, {0u}};
    film_sample_t at = {0u, 0u, 0u};
    uint left = 0u;  // samples of the pixel after this one
    for (uint lane = 0u; lane < count; lane++) {
        if (left == 0u) {
            at = film_sample(scene, first + lane);
            left = scene->batch->samples_a_pixel - (first + lane) % scene->batch->samples_a_pixel;
        } else
            at.index++;
        left--;
        s.x.lane[lane] = at.x;
        s.y.lane[lane] = at.y;
        s.index.lane[lane] = at.index;
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

// Starts `count` samples from `first` on in as many slots, sixteen at most.
static inline void start_paths(const scene_t *scene, const path_t *path, const samples_t *samples, uint first, uint count, const uint *slots)
{
    for (uint channel = 0u; channel < CHANNEL_COUNT; ++channel)
        for (uint lane = 0u; lane < count; lane++)
            sample_set(samples, channel, first + lane, 0.0f);
    const film_samples_t at = film_samples(scene, first, count);
    const each_uint_t seed = {hash_combine_lanes(hash_combine_lanes(scene->render->seed, at.x.all), at.y.all)};
    const sequence_t_lanes sampler = {seed.all, at.index.all};
    each_float_t weight;
    const float2_lanes offset = film_offsets(scene, sample_2d_lanes(&sampler, DIMENSION_FILM), &weight.all);
    float2_lanes lens = {0.0f, 0.0f};
#ifdef CAMERA_LENS
    const pair_t_lanes u = sample_2d_lanes(&sampler, DIMENSION_LENS);
    lens = float2_of_lanes(unit_float_lanes(u.x), unit_float_lanes(u.y));
#endif
    float3_lanes origin, direction;
    camera_ray_lanes(scene->camera, film_point_lanes(scene->render, at.x.all, at.y.all, offset), lens, &origin, &direction);
    origin = add3_lanes(camera_to_world_lanes(scene->camera, origin), camera_position_lanes(scene->camera));
    direction = unit3_lanes(camera_to_world_lanes(scene->camera, direction));
    const each_float_t ox = {origin.x}, oy = {origin.y}, oz = {origin.z}, dx = {direction.x}, dy = {direction.y}, dz = {direction.z};
    for (uint lane = 0u; lane < count; lane++) {
        const uint slot = slots[lane];
        path_set_sample(path, slot, first + lane);
        path_set_depth(path, slot, 0u);
        path_set_seed(path, slot, seed.lane[lane]);
        path_set_index(path, slot, at.index.lane[lane]);
        path_set_origin(path, slot, (float3)(ox.lane[lane], oy.lane[lane], oz.lane[lane]));
        path_set_direction(path, slot, (float3)(dx.lane[lane], dy.lane[lane], dz.lane[lane]));
        path_set_throughput(path, slot, (float3)(weight.lane[lane]));
#ifdef PATH_BSDF_PDF
        path_set_bsdf_pdf(path, slot, 0.0f);
#endif
#ifdef PATH_ETA_SCALE
        path_set_eta_scale(path, slot, 1.0f);
#endif
    }
}

// A work-item does the slots of a group: a census, by which the idle ones get samples, and those that live and those that traced a shadow ray are counted.
kernel SLOT_BY_SLOT UNVECTORIZED void generate(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    const uint begin = (uint)get_global_id(0) * WORK_GROUP_SIZE;
    if (begin == 0u)
        counters[QUEUE_EXTEND_0 + (1u - parity)] = 0u;
    uint slots[WORK_GROUP_SIZE];
    uint idle = 0u, connected = 0u;
    for (uint i = 0u; i < WORK_GROUP_SIZE; i++) {
        slots[idle] = begin + i;
        idle += queue_holds(&queues, QUEUE_IDLE_0, begin + i) ? 1u : 0u;
        connected += queue_holds_connect(&queues, begin + i) ? 1u : 0u;
        queues.connects[begin + i] = 0u;
    }
    const uint end = scene.batch->sample_count, first = idle > 0u ? atomic_add(counters + COUNTER_NEXT_SAMPLE, idle) : end;
    const uint started = first < end ? min(idle, end - first) : 0u;
    if (WORK_GROUP_SIZE - idle + started > 0u)
        atomic_add(counters + QUEUE_EXTEND_0 + parity, WORK_GROUP_SIZE - idle + started);
    if (connected > 0u)
        atomic_add(counters + COUNTER_SHADOW_RAYS, connected);
    for (uint i = 0u; i < started; i++)
        queue_push(&queues, QUEUE_EXTEND_0, slots[i], scratch);
    for (uint i = 0u; i < started; i += LANES)
        start_paths(&scene, &path, &samples, first + i, min(LANES, started - i), slots + i);
}
