// Warps: from the unit square, where random numbers are uniform, to other domains.

#include "lib/circle.cl"
#include "lib/math.cl"

// Uniform in the unit disk; neighbours stay neighbours (Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square").
static inline float2 square_to_disk(float2 u)
{
    const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
    if (a == 0.0f && b == 0.0f)
        return (float2)(0.0f, 0.0f);
    const bool wide = fabs(a) > fabs(b);
    const float r = wide ? a : b;
    const float2 p = circle_octant(0.25f * PI * (wide ? b / a : a / b));
    return r * (wide ? p : p.yx);
}

// Cosine-weighted over the hemisphere z ≥ 0, density z / π: the disk lifted to the sphere (Malley's method; PBR 4ed, §A.5.3).
static inline float3 square_to_cosine_hemisphere(float2 u)
{
    const float2 d = square_to_disk(u);
    return (float3)(d.x, d.y, sqrt(fmax(0.0f, 1.0f - d.x * d.x - d.y * d.y)));
}

// Uniform over the hemisphere z ≥ 0, density 1 / 2π; z = u.x (Archimedes).
static inline float3 square_to_hemisphere(float2 u)
{
    const float r = sqrt(fmax(0.0f, (1.0f - u.x) * (1.0f + u.x)));
    return (float3)(r * circle_point(u.y), u.x);
}
