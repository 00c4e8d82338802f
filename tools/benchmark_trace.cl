// Rays traced, and nothing else: what tools/benchmark_rays.py measures. The scene's parameters and the traversal are those of extend and connect.

#include "lib/math.cl"
#include "lib/shapes.cl"

#define RAY_PARAMETERS global const float *rays, uint count, uint stride
#define RAY_BEGIN \
    uint i = get_global_id(0); \
    if (i >= count) \
        return; \
    ray_t ray; \
    ray.o = (float3)(rays[i], rays[i + stride], rays[i + 2 * (size_t)stride]); \
    ray.d = (float3)(rays[i + 3 * (size_t)stride], rays[i + 4 * (size_t)stride], rays[i + 5 * (size_t)stride]); \
    ray.t_max = rays[i + 6 * (size_t)stride];

kernel WORK_GROUP UNVECTORIZED void trace_nearest_hits(RAY_PARAMETERS, global float *distances, global uint *primitives, SCENE_PARAMETERS)
{
    SCENE_BEGIN
    RAY_BEGIN
    hit_t hit;
    bool found = trace_nearest(&scene, &ray, &hit);
    distances[i] = hit.t;
    primitives[i] = found ? hit.primitive : 0xffffffffu;
}

kernel WORK_GROUP UNVECTORIZED void trace_any_hits(RAY_PARAMETERS, global float *distances, global uint *primitives, SCENE_PARAMETERS)
{
    SCENE_BEGIN
    RAY_BEGIN
    distances[i] = trace_occluded(&scene, &ray) ? 1.0f : 0.0f;
}
