// Tracing and describing whatever shapes the scene holds. A primitive's number counts through all shapes, one shape after the other.

#include "lib/ray.cl"
#include "lib/surface.cl"
#include "scene/shapes.cl"

#ifdef RAY_PACKETS
// Sets t, u, v, primitive and met of the packet's lanes.
static inline void trace_nearest_packet(const scene_t *scene, packet_t *packet)
{
#define NEAREST_OF(NAME) NAME##_nearest_packet(scene, packet);
    FOR_EACH_SHAPE(NEAREST_OF)
}

// Sets met of the packet's lanes.
static inline void trace_occluded_packet(const scene_t *scene, packet_t *packet)
{
#define OCCLUDED_BY(NAME) NAME##_occluded_packet(scene, packet);
    FOR_EACH_SHAPE(OCCLUDED_BY)
}
#else
static inline bool trace_nearest(const scene_t *scene, const ray_t *ray, hit_t *hit)
{
    hit->t = ray->t_max;
    bool found = false;
#define NEAREST_OF(NAME) found = NAME##_nearest(scene, ray, hit) || found;
    FOR_EACH_SHAPE(NEAREST_OF)
    return found;
}

static inline bool trace_occluded(const scene_t *scene, const ray_t *ray)
{
#define OCCLUDED_BY(NAME) \
    if (NAME##_occluded(scene, ray)) \
        return true;
    FOR_EACH_SHAPE(OCCLUDED_BY)
    return false;
}
#endif

static inline surface_t surface_at(const scene_t *scene, const ray_t *ray, const hit_t *hit)
{
#define SURFACE_OF(NAME) \
    if (hit->primitive - scene->render->NAME##_first < scene->render->NAME##_count) \
        return NAME##_surface(scene, hit->primitive - scene->render->NAME##_first, ray, hit);
    FOR_EACH_SHAPE(SURFACE_OF)
    return surface_new((float3)(0.0f), (float3)(0.0f), (float3)(0.0f, 0.0f, 1.0f));
}
