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

kernel WORK_GROUP UNVECTORIZED void extend(STAGE_PARAMETERS)
{
    STAGE_BEGIN
#ifdef QUEUES_COMPACTED
    uint queue = QUEUE_EXTEND_0 + parity;
    uint idle = QUEUE_IDLE_0 + (1u - parity);
#else
    uint queue = QUEUE_EXTEND_0;
    uint idle = QUEUE_IDLE_0;
#endif
    if (get_global_id(0) == 0) {
        counters[COUNTER_RAYS] += counters[QUEUE_EXTEND_0 + parity];
        counters[COUNTER_FIRST_ROUND] = 0u;
    }
    if (queue_is_over(&queues, queue))
        return;
    uint slot = queue_take(&queues, queue);
    uint next = NO_QUEUE;
    if (slot != NO_SLOT) {
        ray_t ray;
        ray.o = path_get_origin(&path, slot);
        ray.d = path_get_direction(&path, slot);
        ray.t_max = INFINITY;
        hit_t hit;
#ifdef SUBSURFACE
        const flight_t flight = flight_of(&path, slot);
        ray.t_max = flight_end(&scene, &path, slot, &flight);
#endif
#ifdef VISIBILITY
        scene.ray_mask = path_get_depth(&path, slot) == 0u ? OBJECT_VISIBLE_TO_CAMERA : 0u;
#endif
#ifdef OPACITY
#ifdef SUBSURFACE
        uint seed = step_seed(&path, slot);
#else
        uint seed = path_get_seed(&path, slot);
#endif
        scene.ray_seed = ray_seed(seed, path_get_index(&path, slot), 2u * path_get_depth(&path, slot));
#endif
#ifdef CAMERA_PARTIAL
        if (path_get_depth(&path, slot) == 0u && is_black(path_get_throughput(&path, slot)))
            next = idle;
        else
#endif
        if (trace_nearest(&scene, &ray, &hit)) {
            path_set_hit(&path, slot, (float3)(hit.t, hit.u, hit.v));
            path_set_primitive(&path, slot, hit.primitive);
#ifdef SUBSURFACE
            flight_pass(&path, slot, &flight, hit.t);
#endif
#if SHADE_QUEUES > 1 || defined(MIXES)
            uint row = scene.primitive_objects[hit.primitive];
#endif
#ifdef MIXES
            sequence_t sampler = sequence_new(&scene, path_get_seed(&path, slot), path_get_index(&path, slot));
            uint which = sample_1d(&sampler, vertex_dimension(path_get_depth(&path, slot), DIMENSION_MIX));
            row = choose_part(&scene, row, &ray, &hit, unit_float(which));
            path_set_object(&path, slot, row);
#endif
#if SHADE_QUEUES > 1
            next = QUEUE_SHADE_0 + scene.objects[row].shade_queue;
#else
            next = QUEUE_SHADE_0;
#endif
#ifdef SUBSURFACE
        } else if (flight.inside && !flight.straight) {
            path_set_hit(&path, slot, (float3)(ray.t_max, 0.0f, 0.0f));
            next = QUEUE_SCATTER;
#endif
        } else {
#ifdef SUBSURFACE
            flight_pass(&path, slot, &flight, INFINITY);  // the body has no far side
#endif
#ifdef INFINITE_LIGHTS
            next = QUEUE_ESCAPE;
#else
            next = idle;
#endif
        }
        RECORD_VISITS(slot, 0u);
    }
    queue_push(&queues, next, slot, scratch);
}
