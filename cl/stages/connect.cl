// connect: traces shadow rays, and adds what each carries where nothing is in its way. Exists only where a light is sampled.
//
// From: shade. To: nothing; the sample buffer.

#include "accel/visits.cl"
#include "lib/path.cl"
#include "lib/queue.cl"
#include "lib/sampler.cl"
#include "lib/samples.cl"
#include "lib/shapes.cl"

static inline ray_t shadow_ray(const path_t *path, uint slot)
{
    ray_t ray;
    ray.o = path_get_shadow_origin(path, slot);
    ray.d = path_get_shadow_direction(path, slot);
    ray.t_max = path_get_shadow_t_max(path, slot);
    return ray;
}

static inline void add_contribution(const scene_t *scene, const path_t *path, const samples_t *samples, uint slot)
{
    sample_add_radiance(scene, samples, path_get_sample(path, slot), path_get_depth(path, slot), path_get_contribution(path, slot));
}

#ifdef RAY_PACKETS

// A work-item traces the rays of sixteen slots.
kernel LANES_GROUP UNVECTORIZED void connect(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    const uint first = (uint)get_global_id(0) * LANES;
    const int16 waiting = queue_holds_connect_lanes(&queues, first);
    if (!any_lane(waiting))
        return;
    const ray_t_lanes rays = {path_get_shadow_origin_lanes(&path, first), path_get_shadow_direction_lanes(&path, first),
                              path_get_shadow_t_max_lanes(&path, first)};
    packet_t packet;
    packet_set(&packet, waiting, &rays);
    trace_occluded_packet(&scene, &packet);
    SHARE_VISITS(packet.rays);
    const each_int_t lit = {waiting & ~packet.met.all};
    for (uint lane = 0u; lane < LANES; lane++)
        if (lit.lane[lane])
            add_contribution(&scene, &path, &samples, first + lane);
    RECORD_VISITS_OF_LANES(waiting, first, 1u);
}

#else

kernel WORK_GROUP UNVECTORIZED void connect(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    uint slot = queue_take_connect(&queues);
    if (slot == NO_SLOT)
        return;
    const ray_t ray = shadow_ray(&path, slot);
#ifdef VISIBILITY
    scene.ray_mask = OBJECT_VISIBLE_TO_SHADOW;
#endif
#ifdef OPACITY
    scene.ray_seed = ray_seed(path_get_seed(&path, slot), path_get_index(&path, slot), 2u * path_get_depth(&path, slot) + 1u);
#endif
    const bool occluded = trace_occluded(&scene, &ray);
    RECORD_VISITS(slot, 1u);
    if (!occluded)
        add_contribution(&scene, &path, &samples, slot);
}

#endif
