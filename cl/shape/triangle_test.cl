// Watertight ray–triangle test (Woop, Benthin & Wald 2013, "Watertight ray/triangle intersection").
//
// In place of the paper's fallback to double precision, the sign of an edge function comes from the rounding errors of its products, which
// a fused multiply-add gives exactly. Every vertex is transformed by the same roundings in all triangles that share it, so the edge functions
// of a shared edge are each other's negatives, and a ray cannot pass between.

#include "lib/ray.cl"

typedef struct {
    uint3 axis;     // x, y, z of the sheared space as axes of the world; z is the one along which the direction is longest
    float3 o;       // origin, in that order
    float3 shear;   // d.x / d.z, d.y / d.z, 1 / d.z
} triangle_ray_t;

static inline triangle_ray_t triangle_prepare(const ray_t *ray)
{
    float3 d = ray->d, o = ray->o, length = as_float3(as_int3(d) & 0x7fffffff);
    // By masks: which axis it is, no processor could foretell for a branch, and fabs is a call on some runtimes.
    const int3 along_x = (int3)(-((length.x >= length.y) & (length.x >= length.z))), along_y = (int3)(-(length.y >= length.z));
    d = along_x ? d.yzx : along_y ? d.zxy : d;
    o = along_x ? o.yzx : along_y ? o.zxy : o;
    triangle_ray_t prepared;
    prepared.axis = along_x ? (uint3)(1, 2, 0) : along_y ? (uint3)(2, 0, 1) : (uint3)(0, 1, 2);
    prepared.o = o;
    prepared.shear = (float3)(d.x / d.z, d.y / d.z, 1.0f / d.z);
    return prepared;
}

// a b − c d with its exact sign, unless products overflow or underflow. Rounding is monotonic: products that differ once rounded differ that way.
static inline float triangle_edge(float a, float b, float c, float d)
{
#pragma OPENCL FP_CONTRACT OFF
    float p = a * b, q = c * d;
    return p != q ? p - q : fma(a, b, -p) - fma(c, d, -q);
}

// A power of two that brings a finite size ≥ 0 to the order of 1.
static inline float triangle_unit_scale(float size)
{
    uint exponent = as_uint(size) >> 23;  // biased by 127, so that of the reciprocal is 254 − exponent
    return as_float((exponent < 253u ? 254u - exponent : 1u) << 23);
}

static inline float triangle_largest(float3 v)
{
    v = fabs(v);
    return fmax(v.x, fmax(v.y, v.z));
}

typedef struct {
    float3 normal;  // along (v1 − v0) × (v2 − v0), of the order of 1 but not unit; 0 where the vertices lie on a line
    float3 terms;   // the sum of the absolute terms of each coordinate of it, to which its rounding errors are relative
} triangle_plane_t;

static inline triangle_plane_t triangle_plane(float3 v0, float3 v1, float3 v2)
{
    float3 e1 = v1 - v0, e2 = v2 - v0;
    e1 *= triangle_unit_scale(triangle_largest(e1));
    e2 *= triangle_unit_scale(triangle_largest(e2));
    float3 n = (float3)(triangle_edge(e1.y, e2.z, e1.z, e2.y), triangle_edge(e1.z, e2.x, e1.x, e2.z), triangle_edge(e1.x, e2.y, e1.y, e2.x));
    float scale = triangle_unit_scale(triangle_largest(n));
    e1 = fabs(e1);
    e2 = fabs(e2);
    triangle_plane_t plane;
    plane.normal = n * scale;
    plane.terms = (e1.yzx * e2.zxy + e1.zxy * e2.yzx) * scale;
    return plane;
}

// Of the barycentrics of a, b and c at the origin of xy, times a common factor (eq. 1 of the paper).
static inline float3 triangle_edges(float3 a, float3 b, float3 c)
{
    return (float3)(triangle_edge(c.x, b.y, c.y, b.x), triangle_edge(a.x, c.y, a.y, c.x), triangle_edge(b.x, a.y, b.y, a.x));
}

static inline bool triangle_is_outside(float3 edges)
{
    return any(edges < 0.0f) && any(edges > 0.0f);
}

// Meets the triangle from either side at 0 < t < t_max, edges included. hit->u and hit->v are the barycentrics of vertices 1 and 2.
static inline bool triangle_intersect(const scene_t *scene, uint index, const ray_t *ray, const triangle_ray_t *prepared, float t_max,
                                      hit_t *hit)
{
#pragma OPENCL FP_CONTRACT OFF
    global const float *v = scene->triangle_vertices + 9 * (size_t)index;
    uint3 axis = prepared->axis;
    float3 v0 = (float3)(v[axis.x], v[axis.y], v[axis.z]);
    float3 v1 = (float3)(v[3 + axis.x], v[3 + axis.y], v[3 + axis.z]);
    float3 v2 = (float3)(v[6 + axis.x], v[6 + axis.y], v[6 + axis.z]);
    float3 a = v0 - prepared->o, b = v1 - prepared->o, c = v2 - prepared->o;
    a.xy -= prepared->shear.xy * a.z;
    b.xy -= prepared->shear.xy * b.z;
    c.xy -= prepared->shear.xy * c.z;

    float3 edges = triangle_edges(a, b, c);
    if (triangle_is_outside(edges))
        return false;
    float determinant = edges.x + edges.y + edges.z;
    if (!(fabs(determinant) > 0x1p-100f && fabs(determinant) < 0x1p100f)) {
        // Seen edge on, or so small or large that products under- or overflowed: decide at the order of 1.
        float2 largest = fmax(fabs(a.xy), fmax(fabs(b.xy), fabs(c.xy)));
        float scale = triangle_unit_scale(fmax(largest.x, largest.y));
        edges = triangle_edges(a * scale, b * scale, c * scale);
        determinant = edges.x + edges.y + edges.z;
        if (triangle_is_outside(edges) || !(fabs(determinant) > 0.0f))
            return false;
    }
    triangle_plane_t plane = triangle_plane(v0, v1, v2);
    // Triangles on a line, which the rounding of the shear may have given an area.
    if (all(plane.normal == (float3)(0.0f)))
        return false;
    // An origin whose height over the plane may be rounding lies in it: a ray does not meet the surface that it leaves (PBR 4ed, §6.8.6).
    // The roundings: of v0 − o, of the edges (2), of their products and difference (2), of the product and the sums here (3).
    float3 to_v0 = v0 - prepared->o;
    float height = dot(to_v0, plane.normal);
    if (!(fabs(height) > 8.0f * 0x1p-24f * dot(fabs(to_v0), plane.terms)))
        return false;
    // Seen almost edge on, the quotient is mostly rounding, but the triangle ends where its vertices do.
    float z = height / dot((float3)(prepared->shear.xy, 1.0f), plane.normal);
    z = fmin(fmax(z, fmin(a.z, fmin(b.z, c.z))), fmax(a.z, fmax(b.z, c.z)));
    float t = z * prepared->shear.z;
    if (!(t > 0.0f && t < t_max))
        return false;
    float3 barycentrics = edges / determinant;
    hit->t = t;
    hit->u = barycentrics.y;
    hit->v = barycentrics.z;
    return true;
}
