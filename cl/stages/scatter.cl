// scatter: where a path's flight through a body ends, takes it there and sends it on in a new direction. Exists only where some body scatters.
//
// From: extend. To: extend; else the slot is idle.
// No light is sampled here: what surrounds the body refracts.

#include "lib/math.cl"
#include "lib/path.cl"
#include "lib/queue.cl"
#include "lib/sampler.cl"
#include "lib/walk.cl"

// Scatters `slot`; says whether its path goes on.
static inline bool scatter_slot(const scene_t *scene, const path_t *path, uint slot)
{
    const flight_t flight = flight_of(path, slot);
    const float distance = path_get_hit(path, slot).x;
    const uint depth = path_get_depth(path, slot), steps = path_get_steps(path, slot) + 1u;
    float3 throughput = path_get_throughput(path, slot) * event_weight(&flight.medium, flight.chances, distance);
    if (is_black(throughput))
        return false;
    const sequence_t sampler = step_sequence(scene, path, slot);
    if (depth + steps >= scene->render->russian_roulette_depth) {
        float scale = 1.0f;
#ifdef PATH_ETA_SCALE
        scale = path_get_eta_scale(path, slot);
#endif
        const float survival = fmin(1.0f, scale * max_component(fabs(throughput)));
        if (unit_float(sample_1d(&sampler, vertex_dimension(depth, DIMENSION_STEP_ROULETTE))) >= survival)
            return false;
        throughput /= survival;
    }
    const pair_t u = sample_2d(&sampler, vertex_dimension(depth, DIMENSION_PHASE));
    const float3 direction = path_get_direction(path, slot);
    path_set_origin(path, slot, path_get_origin(path, slot) + distance * direction);
    path_set_direction(path, slot, phase_sample(flight.medium.g, direction, (float2)(unit_float(u.x), unit_float(u.y))));
    path_set_throughput(path, slot, throughput);
    path_set_steps(path, slot, steps);
    return true;
}

kernel WORK_GROUP UNVECTORIZED void scatter(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    if (queue_is_over(&queues, QUEUE_SCATTER))
        return;
    uint slot = queue_take(&queues, QUEUE_SCATTER);
    uint next = NO_QUEUE;
    if (slot != NO_SLOT) {
        next = scatter_slot(&scene, &path, slot) ? QUEUE_EXTEND_0 : QUEUE_IDLE_0;
#ifdef QUEUES_COMPACTED
        next += 1u - parity;
#endif
    }
    queue_push(&queues, next, slot, scratch);
}
