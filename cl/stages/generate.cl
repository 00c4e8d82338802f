// generate: starts the batch's next samples in the slots that are idle.
//
// From: the idle slots (at first all of them, later those whose paths extend, escape and shade have ended).
// To:   extend.
// Also empties the queues that the last round's stages have read, and counts that round's shadow rays.

#include "lib/film.cl"
#include "lib/filter.cl"
#include "lib/math.cl"
#include "lib/path.cl"
#include "lib/queue.cl"
#include "lib/samples.cl"
#include "lib/sampler.cl"
#include "scene/camera.cl"
#include "scene/cone.cl"
#include "scene/interiors.cl"

#ifdef RAY_CONES
// The cone of the ray through a point of the film, from the ray through a point half a pixel's diagonal away.
static inline cone_t camera_cone(const scene_t *scene, float2 film, float2 lens, float3 origin, float3 direction)
{
    const float2 half_pixel = 0.5f / (float2)((float)scene->render->width, (float)scene->render->height);
    cone_t cone = {0.0f, 0.0f};
    float3 o, d;
    if (camera_ray(scene->camera, film + half_pixel, lens, &o, &d)) {
        cone.width = CONE_PIXELS * M_SQRT2_F * distance(o, origin);
        cone.spread = CONE_PIXELS * M_SQRT2_F * distance(normalize(d), normalize(direction));
    }
    return cone;
}
#endif

// Starts `sample` in `slot`. Where the camera has no ray, the path starts with throughput 0, and extend ends it.
static inline void start_path(const scene_t *scene, const path_t *path, const samples_t *samples, uint sample, uint slot)
{
    for (uint channel = 0u; channel < CHANNEL_COUNT; ++channel)
        sample_set(samples, channel, sample, 0.0f);
    film_sample_t at = film_sample(scene, sample);
    sequence_t sampler = sequence_new(scene, pixel_seed(scene, at), at.index);
    pair_t u = sample_2d(&sampler, DIMENSION_FILM);
    const float2 fx = filter_sample(scene, unit_float(u.x)), fy = filter_sample(scene, unit_float(u.y));
    const float2 offset = (float2)(fx.x, fy.x);
    float weight = fx.y * fy.y;
    const float2 film = film_point(scene->render, at.x, at.y, offset);
    float2 lens = (float2)(0.0f);
#ifdef CAMERA_LENS
    pair_t l = sample_2d(&sampler, DIMENSION_LENS);
    lens = (float2)(unit_float(l.x), unit_float(l.y));
#endif
    float3 origin, direction;
    if (!camera_ray(scene->camera, film, lens, &origin, &direction)) {
        weight = 0.0f;
        origin = (float3)(0.0f);
        direction = (float3)(0.0f, 0.0f, -1.0f);
    }
    path_set_sample(path, slot, sample);
    path_set_depth(path, slot, 0u);
    path_set_seed(path, slot, sampler.seed);
    path_set_index(path, slot, sampler.index);
    path_set_origin(path, slot, add3(camera_to_world(scene->camera, origin), camera_position(scene->camera)));
    path_set_direction(path, slot, normalize(camera_to_world(scene->camera, direction)));
    path_set_throughput(path, slot, (float3)(weight));
#ifdef PATH_BSDF_PDF
    path_set_bsdf_pdf(path, slot, 0.0f);
#endif
#ifdef RAY_CONES
    const cone_t cone = camera_cone(scene, film, lens, origin, direction);
    path_set_cone_width(path, slot, cone.width);
    path_set_cone_spread(path, slot, cone.spread);
#endif
#ifdef NESTED
    const interiors_t outside = {{0u}};
    interiors_set(path, slot, &outside);
#endif
#ifdef PATH_ETA_SCALE
    path_set_eta_scale(path, slot, 1.0f);
#endif
#ifdef SUBSURFACE
    path_set_extinction(path, slot, (float3)(0.0f));
    path_set_steps(path, slot, 0u);
#endif
}

#ifdef QUEUES_COMPACTED

kernel WORK_GROUP void generate(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    if (get_global_id(0) == 0) {
        counters[COUNTER_SHADOW_RAYS] += counters[QUEUE_CONNECT];
        for (uint q = QUEUE_CONNECT; q < QUEUE_COUNT; ++q)
            counters[q] = 0u;
        counters[QUEUE_IDLE_0 + (1u - parity)] = 0u;
        counters[QUEUE_EXTEND_0 + (1u - parity)] = 0u;
    }
    if (queue_is_over(&queues, QUEUE_IDLE_0 + parity))
        return;
    // In a batch's first round every slot is idle, and no list of them is needed.
    uint slot = queue_take(&queues, QUEUE_IDLE_0 + parity);
    if (counters[COUNTER_FIRST_ROUND] && slot != NO_SLOT)
        slot = (uint)get_global_id(0);
    uint want = slot != NO_SLOT ? 0u : NO_QUEUE;
    local ulong *wishes = (local ulong *)(scratch + SCRATCH_WISHES);
    local uint *tallies = scratch + SCRATCH_TALLIES;
    group_clear(tallies);
    group_wish(want, wishes);
    barrier(CLK_LOCAL_MEM_FENCE);
    place_t place = group_tally(want, wishes, tallies);
    barrier(CLK_LOCAL_MEM_FENCE);
    place = group_place(want, place, tallies);
    if (want == 0u && place.rank == 0u) {
        uint first = atomic_add(counters + COUNTER_NEXT_SAMPLE, place.count);
        uint started = first < scene.batch->sample_count ? min(place.count, scene.batch->sample_count - first) : 0u;
        scratch[0] = first;
        scratch[1] = started > 0u ? atomic_add(counters + QUEUE_EXTEND_0 + parity, started) : 0u;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    // Those that come first get the batch's last samples, so that they are also the first in the queue.
    uint sample = scratch[0] + place.rank;
    if (want == 0u && sample < scene.batch->sample_count) {
        start_path(&scene, &path, &samples, sample, slot);
        queue_store(&queues, QUEUE_EXTEND_0 + parity, scratch[1] + place.rank, slot);
    }
}

#else

// One census of the group's slots: the idle ones get samples, those that live and those that traced a shadow ray are counted.
kernel WORK_GROUP void generate(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    local uint *idle = scratch, *live = scratch + 1, *connected = scratch + 2;
    uint slot = (uint)get_global_id(0);
    if (slot == 0)
        counters[QUEUE_EXTEND_0 + (1u - parity)] = 0u;
    if (get_local_id(0) == 0)
        *idle = *live = *connected = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    bool wants = queues.tags[slot] == QUEUE_IDLE_0;
    uint rank = 0u;
    if (wants)
        rank = atomic_inc(idle);
    else
        atomic_inc(live);
    if (queues.connects[slot] != 0u) {
        queues.connects[slot] = 0u;
        atomic_inc(connected);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) {
        uint first = *idle > 0u ? atomic_add(counters + COUNTER_NEXT_SAMPLE, *idle) : 0u;
        uint started = first < scene.batch->sample_count ? min(*idle, scene.batch->sample_count - first) : 0u;
        if (*live + started > 0u)
            atomic_add(counters + QUEUE_EXTEND_0 + parity, *live + started);
        if (*connected > 0u)
            atomic_add(counters + COUNTER_SHADOW_RAYS, *connected);
        *idle = first;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    uint sample = *idle + rank;
    if (wants && sample < scene.batch->sample_count) {
        start_path(&scene, &path, &samples, sample, slot);
        queues.tags[slot] = QUEUE_EXTEND_0;
    }
}

#endif
