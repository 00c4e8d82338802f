// Rays traced, and nothing else: what tools/benchmark_rays.py measures. The scene's parameters and the traversal are those of extend and connect, as is
// how rays are shared out to work-items.

#include "lib/math.cl"
#include "lib/shapes.cl"

#ifdef QUEUES_COMPACTED
#define RAYS_GROUP WORK_GROUP
#define RAYS_A_WORK_ITEM 1u
#else
#define RAYS_GROUP SLOT_BY_SLOT
#define RAYS_A_WORK_ITEM WORK_GROUP_SIZE
#endif

#define RAY_PARAMETERS global const float *rays, uint count, uint stride

static inline ray_t ray_number(global const float *rays, uint stride, size_t i)
{
    ray_t ray;
    ray.o = (float3)(rays[i], rays[i + stride], rays[i + 2 * (size_t)stride]);
    ray.d = (float3)(rays[i + 3 * (size_t)stride], rays[i + 4 * (size_t)stride], rays[i + 5 * (size_t)stride]);
    ray.t_max = rays[i + 6 * (size_t)stride];
    return ray;
}

kernel RAYS_GROUP UNVECTORIZED void trace_nearest_hits(RAY_PARAMETERS, global float *distances, global uint *primitives, SCENE_PARAMETERS)
{
    SCENE_BEGIN
    const uint first = (uint)get_global_id(0) * RAYS_A_WORK_ITEM;
    for (uint i = first; i < first + RAYS_A_WORK_ITEM && i < count; i++) {
        const ray_t ray = ray_number(rays, stride, i);
        hit_t hit;
        const bool found = trace_nearest(&scene, &ray, &hit);
        distances[i] = hit.t;
        primitives[i] = found ? hit.primitive : 0xffffffffu;
    }
}

kernel RAYS_GROUP UNVECTORIZED void trace_any_hits(RAY_PARAMETERS, global float *distances, global uint *primitives, SCENE_PARAMETERS)
{
    SCENE_BEGIN
    const uint first = (uint)get_global_id(0) * RAYS_A_WORK_ITEM;
    for (uint i = first; i < first + RAYS_A_WORK_ITEM && i < count; i++) {
        const ray_t ray = ray_number(rays, stride, i);
        distances[i] = trace_occluded(&scene, &ray) ? 1.0f : 0.0f;
    }
}
