// Points of sixteen triangles: vertices are fetched lane by lane, the rest is done in vectors.

#include "scene/lanes.cl"
#include "shape/triangle.cl"

// Rows begin anywhere; vload4 is a call on PyPI's PoCL.
typedef float4 float4_anywhere __attribute__((aligned(4)));

static inline float4 row_of(global const float *vertices, uint row)
{
    return *(global const float4_anywhere *)(vertices + 4u * row);
}

// The points of the triangles `index` with barycentrics b, and the triangles' areas.
static inline surface_t_lanes triangle_at_lanes(const scene_t *scene, const each_uint_t *index, float3_lanes b, float16 *area)
{
    each_float_t x0, y0, z0, x1, y1, z1, x2, y2, z2;
    for (uint lane = 0u; lane < LANES; lane += 4u) {
        // Four at a time, so that rows are loaded and turned into columns; number by number, fetching takes half as long again as all that follows.
        global const float *a = scene->triangle_vertices + 9 * (size_t)index->lane[lane];
        global const float *b = scene->triangle_vertices + 9 * (size_t)index->lane[lane + 1u];
        global const float *c = scene->triangle_vertices + 9 * (size_t)index->lane[lane + 2u];
        global const float *d = scene->triangle_vertices + 9 * (size_t)index->lane[lane + 3u];
        const float4 a0 = row_of(a, 0u), b0 = row_of(b, 0u), c0 = row_of(c, 0u), d0 = row_of(d, 0u);
        const float4 a1 = row_of(a, 1u), b1 = row_of(b, 1u), c1 = row_of(c, 1u), d1 = row_of(d, 1u);
        x0.four[lane / 4u] = (float4)(a0.x, b0.x, c0.x, d0.x);
        y0.four[lane / 4u] = (float4)(a0.y, b0.y, c0.y, d0.y);
        z0.four[lane / 4u] = (float4)(a0.z, b0.z, c0.z, d0.z);
        x1.four[lane / 4u] = (float4)(a0.w, b0.w, c0.w, d0.w);
        y1.four[lane / 4u] = (float4)(a1.x, b1.x, c1.x, d1.x);
        z1.four[lane / 4u] = (float4)(a1.y, b1.y, c1.y, d1.y);
        x2.four[lane / 4u] = (float4)(a1.z, b1.z, c1.z, d1.z);
        y2.four[lane / 4u] = (float4)(a1.w, b1.w, c1.w, d1.w);
        z2.four[lane / 4u] = (float4)(a[8], b[8], c[8], d[8]);
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
