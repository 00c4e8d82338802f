// The surfaces that sixteen paths met, where all are triangles.

#include "lib/path.cl"
#include "shape/triangle_lanes.cl"

static inline surface_t_lanes surfaces_met(const scene_t *scene, const path_t *path, uint first, int16 waiting, const each_uint_t *primitive)
{
    const float3_lanes hit = path_get_hit_lanes(path, first);
    const each_uint_t triangle = {primitive->all - scene->render->triangle_first};
    float16 area;
    return triangle_at_lanes(scene, &triangle, float3_of_lanes(1.0f - hit.y - hit.z, hit.y, hit.z), &area);
}
