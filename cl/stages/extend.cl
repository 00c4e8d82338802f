// extend: traces each path's ray to the nearest surface.
//
// From: generate (new paths), shade and scatter (paths that go on).
// To:   shade, by the kind of BSDF that was met; scatter, where a walk in a body met none; escape, where there is something beyond the scene; else the slot is idle.

#include "accel/visits.cl"
#include "lib/math.cl"
#include "lib/mix.cl"
#include "lib/path.cl"
#include "lib/queue.cl"
#include "lib/sampler.cl"
#include "lib/shapes.cl"
#include "scene/walk.cl"

#ifdef QUEUES_COMPACTED
#define IDLE (QUEUE_IDLE_0 + (1u - parity))
#else
#define IDLE QUEUE_IDLE_0
#endif

// Has the camera no ray for this path?
static inline bool is_unborn(const path_t *path, uint slot)
{
#ifdef CAMERA_PARTIAL
    return path_get_depth(path, slot) == 0u && is_black(path_get_throughput(path, slot));
#else
    return false;
#endif
}

// The queue of the BSDF that the path met.
static inline uint shade_queue(const scene_t *scene, const path_t *path, uint slot, const ray_t *ray, const hit_t *hit)
{
#if SHADE_QUEUES > 1 || defined(MIXES)
    uint row = scene->primitive_objects[hit->primitive];
#endif
#ifdef MIXES
    sequence_t sampler = sequence_new(scene, path_get_seed(path, slot), path_get_index(path, slot));
    uint which = sample_1d(&sampler, vertex_dimension(path_get_depth(path, slot), DIMENSION_MIX));
    row = choose_part(scene, row, ray, hit, unit_float(which));
    path_set_object(path, slot, row);
#endif
#if SHADE_QUEUES > 1
    return QUEUE_SHADE_0 + scene->objects[row].shade_queue;
#else
    return QUEUE_SHADE_0;
#endif
}

static inline void count_rays(global uint *counters, uint parity)
{
    if (get_global_id(0) == 0) {
        counters[COUNTER_RAYS] += counters[QUEUE_EXTEND_0 + parity];
        counters[COUNTER_FIRST_ROUND] = 0u;
    }
}

#ifdef INFINITE_LIGHTS
#define BEYOND QUEUE_ESCAPE
#else
#define BEYOND IDLE
#endif

#ifdef RAY_PACKETS

// A work-item traces the rays of sixteen slots.
kernel LANES_GROUP UNVECTORIZED void extend(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    count_rays(counters, parity);
    const uint first = (uint)get_global_id(0) * LANES;
    const int16 waiting = queue_holds_lanes(&queues, QUEUE_EXTEND_0, first);
    if (!any_lane(waiting))
        return;
    int16 unborn = 0;
#ifdef CAMERA_PARTIAL
    unborn = (path_get_depth_lanes(&path, first) == 0u) & is_black_lanes(path_get_throughput_lanes(&path, first));
#endif
    const ray_t_lanes rays = {path_get_origin_lanes(&path, first), path_get_direction_lanes(&path, first), INFINITY};
    packet_t packet;
    packet_set(&packet, waiting & ~unborn, &rays);
    trace_nearest_packet(&scene, &packet);
    SHARE_VISITS(packet.rays);
    const float3_lanes t_u_v = {packet.t.all, packet.u.all, packet.v.all};
    path_set_hit_lanes(&path, first, packet.met.all, t_u_v);
    path_set_primitive_lanes(&path, first, packet.met.all, packet.primitive.all);
    each_uint_t next;
    next.all = packet.met.all ? QUEUE_SHADE_0 : unborn ? IDLE : BEYOND;
#if SHADE_QUEUES > 1 || defined(MIXES)
    for (uint lane = 0u; lane < LANES; lane++) {
        if (!packet.met.lane[lane])
            continue;
        const ray_t ray = packet_ray(&packet, lane);
        const hit_t hit = packet_hit(&packet, lane);
        next.lane[lane] = shade_queue(&scene, &path, first + lane, &ray, &hit);
    }
#endif
    queue_push_lanes(&queues, waiting, next.all, first);
    RECORD_VISITS_OF_LANES(waiting, first, 0u);
}

#else

// Traces a path's ray; the queue that the path goes to.
static inline uint extend_path(scene_t *scene, const path_t *path, uint slot, uint parity)
{
    ray_t ray;
    ray.o = path_get_origin(path, slot);
    ray.d = path_get_direction(path, slot);
    ray.t_max = INFINITY;
#ifdef SUBSURFACE
    const flight_t flight = flight_of(path, slot);
    ray.t_max = flight_end(scene, path, slot, &flight);
#endif
#ifdef VISIBILITY
    scene->ray_mask = path_get_depth(path, slot) == 0u ? OBJECT_VISIBLE_TO_CAMERA : 0u;
#endif
#ifdef OPACITY
#ifdef SUBSURFACE
    uint seed = step_seed(path, slot);
#else
    uint seed = path_get_seed(path, slot);
#endif
    scene->ray_seed = ray_seed(seed, path_get_index(path, slot), 2u * path_get_depth(path, slot));
#endif
    if (is_unborn(path, slot))
        return IDLE;
    hit_t hit;
    if (trace_nearest(scene, &ray, &hit)) {
        path_set_hit(path, slot, (float3)(hit.t, hit.u, hit.v));
        path_set_primitive(path, slot, hit.primitive);
#ifdef SUBSURFACE
        flight_pass(path, slot, &flight, hit.t);
#endif
        return shade_queue(scene, path, slot, &ray, &hit);
    }
#ifdef SUBSURFACE
    if (flight.inside && !flight.straight) {
        path_set_hit(path, slot, (float3)(ray.t_max, 0.0f, 0.0f));
        return QUEUE_SCATTER;
    }
    flight_pass(path, slot, &flight, INFINITY);  // the body has no far side
#endif
    return BEYOND;
}

#ifdef QUEUES_COMPACTED

kernel WORK_GROUP UNVECTORIZED void extend(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    const uint queue = QUEUE_EXTEND_0 + parity;
    count_rays(counters, parity);
    if (queue_is_over(&queues, queue))
        return;
    const uint slot = queue_take(&queues, queue);
    uint next = NO_QUEUE;
    if (slot != NO_SLOT) {
        next = extend_path(&scene, &path, slot, parity);
        RECORD_VISITS(slot, 0u);
    }
    queue_push(&queues, next, slot, scratch);
}

#else

// A work-item does the slots of a group, so that they share one stack (docs/performance.md).
kernel SLOT_BY_SLOT UNVECTORIZED void extend(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    count_rays(counters, parity);
    for (uint i = 0u; i < WORK_GROUP_SIZE; i++) {
        const uint slot = (uint)get_global_id(0) * WORK_GROUP_SIZE + i;
        if (!queue_holds(&queues, QUEUE_EXTEND_0, slot))
            continue;
        queue_push(&queues, extend_path(&scene, &path, slot, parity), slot, scratch);
        RECORD_VISITS(slot, 0u);
        FORGET_VISITS
    }
}

#endif

#endif
