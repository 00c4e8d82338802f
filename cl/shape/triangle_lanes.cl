// Points of sixteen triangles: vertices are fetched lane by lane, the rest is done in vectors.

#include "scene/lanes.cl"
#include "shape/triangle.cl"

// The points of the triangles `index` with barycentrics b, and the triangles' areas.
static inline surface_t_lanes triangle_at_lanes(const scene_t *scene, const each_uint_t *index, float3_lanes b, float16 *area)
{
    each_float_t x0, y0, z0, x1, y1, z1, x2, y2, z2;
    for (uint lane = 0u; lane < LANES; lane++) {
        global const float *v = scene->triangle_vertices + 9 * (size_t)index->lane[lane];
        x0.lane[lane] = v[0];
        y0.lane[lane] = v[1];
        z0.lane[lane] = v[2];
        x1.lane[lane] = v[3];
        y1.lane[lane] = v[4];
        z1.lane[lane] = v[5];
        x2.lane[lane] = v[6];
        y2.lane[lane] = v[7];
        z2.lane[lane] = v[8];
    }
    const float3_lanes v0 = {x0.all, y0.all, z0.all}, v1 = {x1.all, y1.all, z1.all}, v2 = {x2.all, y2.all, z2.all};
    const float3_lanes e1 = subtract3_lanes(v1, v0), e2 = subtract3_lanes(v2, v0), n = cross3_lanes(e1, e2);
    float3_lanes normal = triangle_unit_lanes(n, area);
    each_int_t plain = {triangle_is_plain_lanes(n)};
    if (any_lane(~plain.all)) {
        each_float_t x = {normal.x}, y = {normal.y}, z = {normal.z}, areas = {*area};
        for (uint lane = 0u; lane < LANES; lane++) {
            if (plain.lane[lane])
                continue;
            const float3 one = triangle_normal(lane_of(&e1, lane), lane_of(&e2, lane), &areas.lane[lane]);
            x.lane[lane] = one.x;
            y.lane[lane] = one.y;
            z.lane[lane] = one.z;
        }
        normal.x = x.all;
        normal.y = y.all;
        normal.z = z.all;
        *area = areas.all;
    }
    return triangle_point_lanes(v0, v1, v2, b, normal);
}
