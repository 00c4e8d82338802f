// The surfaces that sixteen paths met, of whatever shapes: path by path.

#include "lib/path.cl"
#include "lib/shapes.cl"
#include "scene/lanes.cl"

static inline surface_t_lanes surfaces_met(const scene_t *scene, const path_t *path, uint first, int16 waiting, const each_uint_t *primitive)
{
    const each_int_t wanted = {waiting};
    each_float_t px = {0.0f}, py = {0.0f}, pz = {0.0f}, ex = {0.0f}, ey = {0.0f}, ez = {0.0f}, nx = {0.0f}, ny = {0.0f}, nz = {1.0f};
    for (uint lane = 0u; lane < LANES; lane++) {
        if (!wanted.lane[lane])
            continue;
        const ray_t ray = {path_get_origin(path, first + lane), path_get_direction(path, first + lane), INFINITY};
        const float3 t_u_v = path_get_hit(path, first + lane);
        const hit_t hit = {t_u_v.x, t_u_v.y, t_u_v.z, primitive->lane[lane]};
        const surface_t s = surface_at(scene, &ray, &hit);
        px.lane[lane] = s.p.x;
        py.lane[lane] = s.p.y;
        pz.lane[lane] = s.p.z;
        ex.lane[lane] = s.error.x;
        ey.lane[lane] = s.error.y;
        ez.lane[lane] = s.error.z;
        nx.lane[lane] = s.ng.x;
        ny.lane[lane] = s.ng.y;
        nz.lane[lane] = s.ng.z;
    }
    return surface_new_lanes(float3_of_lanes(px.all, py.all, pz.all), float3_of_lanes(ex.all, ey.all, ez.all), float3_of_lanes(nx.all, ny.all, nz.all));
}
