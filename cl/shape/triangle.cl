// Triangles. scene->triangle_vertices holds nine floats each; what vertices carry is found through scene->triangle_corners.

#include "lib/math.cl"
#include "lib/surface.cl"
#include "lib/warp.cl"
#include "shape/triangle_point.cl"
#include "shape/triangle_test.cl"

// The unit normal along e1 × e2, and half the length of that, the area.
static inline float3 triangle_normal(float3 e1, float3 e2, float *area)
{
    float3 n = cross3(e1, e2);
    float unscale = 1.0f;
    if (!triangle_is_plain(n)) {
        // Brought to the order of 1 first: the cross product of small edges would underflow.
        float scale = triangle_unit_scale(fmax(triangle_largest(e1), triangle_largest(e2)));
        n = cross3(e1 * scale, e2 * scale);
        unscale = 1.0f / scale;
    }
    n = triangle_unit(n, area);
    *area *= unscale * unscale;
    return n;
}

#ifdef VERTEX_NORMALS
// Adds a vertex's share of the way from the triangle to the surface that is tangent to the vertices' planes: what p lies below the plane through v
// with normal n, times the vertex's barycentric (Hanika 2021, "Hacking the Shadow Terminator", Ray Tracing Gems II).
static inline void triangle_lift(float3 v, float3 n, float b, surface_t *s)
{
    const float height = dot(s->p - v, n);
    if (height < 0.0f)
        s->lift_above -= b * height * n;
    else
        s->lift_below -= b * height * n;
}
#endif

#ifdef TRIANGLE_CORNERS
// Adds what the vertices carry: normals, uv and its tangents, colours.
static inline void triangle_interpolate(const scene_t *scene, uint index, float3 v0, float3 v1, float3 v2, float3 b, surface_t *s)
{
    global const uint *corner = scene->triangle_corners + 3 * (size_t)index;
    if (corner[0] == 0xffffffffu) {
#ifdef SURFACE_UV
        s->uv = b.yz;
#endif
        return;
    }
#ifdef VERTEX_NORMALS
    const float3 n0 = load3(scene->vertex_normals + 3 * (size_t)corner[0]), n1 = load3(scene->vertex_normals + 3 * (size_t)corner[1]);
    const float3 n2 = load3(scene->vertex_normals + 3 * (size_t)corner[2]);
    const float3 n = b.x * n0 + b.y * n1 + b.z * n2;
    const float length2 = dot(n, n);
    if (length2 > 0.0f) {
        const float side = dot(n, s->ng) < 0.0f ? -1.0f : 1.0f;
        s->ns = n * (side * rsqrt(length2));
        triangle_lift(v0, side * n0, b.x, s);
        triangle_lift(v1, side * n1, b.y, s);
        triangle_lift(v2, side * n2, b.z, s);
    }
#endif
#ifdef SURFACE_UV
    float2 t0 = (float2)(0.0f), t1 = (float2)(1.0f, 0.0f), t2 = (float2)(0.0f, 1.0f);
#ifdef VERTEX_UVS
    global const float *uvs = scene->vertex_uvs;
    if (!isnan(uvs[2 * (size_t)corner[0]])) {
        t0 = (float2)(uvs[2 * (size_t)corner[0]], uvs[2 * (size_t)corner[0] + 1]);
        t1 = (float2)(uvs[2 * (size_t)corner[1]], uvs[2 * (size_t)corner[1] + 1]);
        t2 = (float2)(uvs[2 * (size_t)corner[2]], uvs[2 * (size_t)corner[2] + 1]);
    }
#endif
    s->uv = b.x * t0 + b.y * t1 + b.z * t2;
#ifdef SURFACE_TANGENT
    // p(u, v) is linear over the triangle: its derivatives solve a 2 × 2 system (PBR 4ed, eq. 6.6).
    float2 d1 = t1 - t0, d2 = t2 - t0;
    float determinant = d1.x * d2.y - d1.y * d2.x;
    if (determinant != 0.0f) {
        s->dpdu = (d2.y * (v1 - v0) - d1.y * (v2 - v0)) / determinant;
        s->dpdv = (d1.x * (v2 - v0) - d2.x * (v1 - v0)) / determinant;
    }
#endif
#endif
#ifdef SURFACE_COLOR
    s->color = b.x * load3(scene->vertex_colors + 3 * (size_t)corner[0]) + b.y * load3(scene->vertex_colors + 3 * (size_t)corner[1])
             + b.z * load3(scene->vertex_colors + 3 * (size_t)corner[2]);
#endif
}
#endif

static inline surface_t triangle_at(const scene_t *scene, uint index, float3 b, float *area)
{
    global const float *v = scene->triangle_vertices + 9 * (size_t)index;
    float3 v0 = load3(v), v1 = load3(v + 3), v2 = load3(v + 6);
    surface_t s = triangle_point(v0, v1, v2, b, triangle_normal(v1 - v0, v2 - v0, area));
#ifdef TRIANGLE_CORNERS
    triangle_interpolate(scene, index, v0, v1, v2, b, &s);
#endif
    return s;
}

static inline surface_t triangle_surface(const scene_t *scene, uint index, const ray_t *ray, const hit_t *hit)
{
    float area;
    return triangle_at(scene, index, (float3)(1.0f - hit->u - hit->v, hit->u, hit->v), &area);
}

// Uniform over the area.
static inline light_point_t triangle_sample(const scene_t *scene, uint index, float3 reference, float2 u)
{
    light_point_t point;
    float area;
    point.surface = triangle_at(scene, index, square_to_triangle(u), &area);
    point.pdf = area_to_solid_angle(1.0f / area, reference, &point.surface);
    return point;
}

static inline float triangle_sample_pdf(const scene_t *scene, uint index, float3 reference, const surface_t *surface)
{
    global const float *v = scene->triangle_vertices + 9 * (size_t)index;
    float area;
    triangle_normal(load3(v + 3) - load3(v), load3(v + 6) - load3(v), &area);
    return area_to_solid_angle(1.0f / area, reference, surface);
}
