// Points and normals of triangles. For one path or sixteen (lib/lanes.cl).

#include "lib/surface.cl"

// Is n = e1 × e2 neither so small nor so large that its square is off?
static inline bool triangle_is_plain(float3 n)
{
    const float length2 = dot3(n, n);
    return length2 > 1e-30f && length2 < 1e30f;
}

// n = e1 × e2 brought to length 1, and half of what it was, the area.
static inline float3 triangle_unit(float3 n, float *area)
{
    const float length = sqrt(dot3(n, n));
    *area = 0.5f * length;
    return float3_of(n.x / length, n.y / length, n.z / length);
}

// Point with barycentrics b of the vertices v0, v1, v2 and the bound of its error (PBR 4ed, §6.8.5).
static inline surface_t triangle_point(float3 v0, float3 v1, float3 v2, float3 b, float3 normal)
{
    const float3 p0 = scale3(v0, b.x), p1 = scale3(v1, b.y), p2 = scale3(v2, b.z);
    const float3 error = scale3(add3(add3(absolute3(p0), absolute3(p1)), absolute3(p2)), GAMMA(7));
    return surface_new(add3(add3(p0, p1), p2), error, normal);
}
