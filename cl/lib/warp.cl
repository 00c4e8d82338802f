// Warps: from the unit square, where random numbers are uniform, to other domains. For one path or sixteen (lib/lanes.cl).

#include "lib/circle.cl"
#include "lib/math.cl"

// Uniform in the unit disk; neighbours stay neighbours (Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square").
static inline float2 square_to_disk(float2 u)
{
    const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
    const bool wide = absolute(a) > absolute(b);
    const float r = wide ? a : b, other = wide ? b : a;
    const float2 p = circle_octant(0.25f * PI * (other / (r == 0.0f ? 1.0f : r)));
    return float2_of(r * (wide ? p.x : p.y), r * (wide ? p.y : p.x));
}

// Cosine-weighted over the hemisphere z ≥ 0, density z / π: the disk lifted to the sphere (Malley's method; PBR 4ed, §A.5.3).
static inline float3 square_to_cosine_hemisphere(float2 u)
{
    const float2 d = square_to_disk(u);
    return float3_of(d.x, d.y, sqrt(larger(1.0f - d.x * d.x - d.y * d.y, 0.0f)));
}

// Uniform over the hemisphere z ≥ 0, density 1 / 2π; z = u.x (Archimedes).
static inline float3 square_to_hemisphere(float2 u)
{
    const float r = sqrt(larger((1.0f - u.x) * (1.0f + u.x), 0.0f));
    const float2 p = circle_point(u.y);
    return float3_of(r * p.x, r * p.y, u.x);
}

// Uniform over the sphere, density 1 / 4π; z = 1 − 2 u.x (Archimedes).
static inline float3 square_to_sphere(float2 u)
{
    const float z = 1.0f - 2.0f * u.x, r = sqrt(larger(1.0f - z * z, 0.0f));
    const float2 p = circle_point(u.y);
    return float3_of(r * p.x, r * p.y, z);
}

// Barycentrics, uniform over a triangle, by a fold that keeps strata compact (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
static inline float3 square_to_triangle(float2 u)
{
    const bool below = u.x > u.y;
    const float b1 = below ? u.x - 0.5f * u.y : 0.5f * u.x, b2 = below ? 0.5f * u.y : u.y - 0.5f * u.x;
    return float3_of(1.0f - b1 - b2, b1, b2);
}
