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

// The first work-item of sixteen traces the rays of all.
kernel WORK_GROUP UNVECTORIZED void connect(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    const uint first = (uint)get_global_id(0);
    if (first % PACKET != 0u)
        return;
    packet_t packet;
    packet.rays = 0u;
    for (uint lane = 0u; lane < PACKET; lane++) {
        packet_set_none(&packet, lane);
        if (queue_holds_connect(&queues, first + lane)) {
            const ray_t ray = shadow_ray(&path, first + lane);
            packet_set(&packet, lane, &ray);
            packet.rays++;
        }
    }
    if (packet.rays == 0u)
        return;
    trace_occluded_packet(&scene, &packet);
    SHARE_VISITS(packet.rays);
    for (uint lane = 0u; lane < PACKET; lane++) {
        if (!queue_holds_connect(&queues, first + lane))
            continue;
        RECORD_VISITS(first + lane, 1u);
        if (!packet.met[lane])
            add_contribution(&scene, &path, &samples, first + lane);
    }
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
