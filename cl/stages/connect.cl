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

// The shadow rays of sixteen slots, which need not be neighbours.
static inline ray_t_lanes shadow_rays(const path_t *path, const uint *slots, uint count)
{
    each_float_t ox, oy, oz, dx, dy, dz, t_max;
    ONE_BY_ONE
    for (uint lane = 0u; lane < LANES; lane++) {
        const ray_t ray = shadow_ray(path, slots[lane < count ? lane : 0u]);
        ox.lane[lane] = ray.o.x;
        oy.lane[lane] = ray.o.y;
        oz.lane[lane] = ray.o.z;
        dx.lane[lane] = ray.d.x;
        dy.lane[lane] = ray.d.y;
        dz.lane[lane] = ray.d.z;
        t_max.lane[lane] = ray.t_max;
    }
    const ray_t_lanes rays = {{ox.all, oy.all, oz.all}, {dx.all, dy.all, dz.all}, t_max.all};
    return rays;
}

// A work-item does the slots of a group: those that have a shadow ray, half of them perhaps, fill packets.
kernel SLOT_BY_SLOT UNVECTORIZED void connect(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    uint slots[WORK_GROUP_SIZE];
    uint waiting = 0u;
    for (uint i = 0u; i < WORK_GROUP_SIZE; i++) {
        const uint slot = (uint)get_global_id(0) * WORK_GROUP_SIZE + i;
        slots[waiting] = slot;
        waiting += queue_holds_connect(&queues, slot) ? 1u : 0u;
    }
    for (uint first = 0u; first < waiting; first += LANES) {
        const uint count = min(LANES, waiting - first);
        const ray_t_lanes rays = shadow_rays(&path, slots + first, count);
        packet_t packet;
        packet_set(&packet, LANE_NUMBERS < count, &rays);
        trace_occluded_packet(&scene, &packet);
        SHARE_VISITS(count);
        for (uint lane = 0u; lane < count; lane++) {
            if (!packet.met.lane[lane])
                add_contribution(&scene, &path, &samples, slots[first + lane]);
            RECORD_VISITS(slots[first + lane], 1u);
        }
        FORGET_VISITS
    }
}

#else

static inline void connect_path(scene_t *scene, const path_t *path, const samples_t *samples, uint slot)
{
    const ray_t ray = shadow_ray(path, slot);
#ifdef VISIBILITY
    scene->ray_mask = OBJECT_VISIBLE_TO_SHADOW;
#endif
#ifdef OPACITY
    scene->ray_seed = ray_seed(path_get_seed(path, slot), path_get_index(path, slot), 2u * path_get_depth(path, slot) + 1u);
#endif
    if (!trace_occluded(scene, &ray))
        add_contribution(scene, path, samples, slot);
}

#ifdef QUEUES_COMPACTED

kernel WORK_GROUP UNVECTORIZED void connect(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    const uint slot = queue_take(&queues, QUEUE_CONNECT);
    if (slot == NO_SLOT)
        return;
    connect_path(&scene, &path, &samples, slot);
    RECORD_VISITS(slot, 1u);
}

#else

// As extend.
kernel SLOT_BY_SLOT UNVECTORIZED void connect(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    for (uint i = 0u; i < WORK_GROUP_SIZE; i++) {
        const uint slot = (uint)get_global_id(0) * WORK_GROUP_SIZE + i;
        if (!queue_holds_connect(&queues, slot))
            continue;
        connect_path(&scene, &path, &samples, slot);
        RECORD_VISITS(slot, 1u);
        FORGET_VISITS
    }
}

#endif

#endif
