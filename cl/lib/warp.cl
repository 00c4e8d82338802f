// Warps: from the unit square, where random numbers are uniform, to other domains.

#include "lib/math.cl"

// Uniform in the unit disk; neighbours stay neighbours (Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square").
static inline float2 square_to_disk(float2 u)
{
    const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
    if (a == 0.0f && b == 0.0f)
        return (float2)(0.0f, 0.0f);
    const bool wide = fabs(a) > fabs(b);
    const float r = wide ? a : b;
    const float phi = wide ? 0.25f * PI * (b / a) : 0.5f * PI - 0.25f * PI * (a / b);
    return r * (float2)(cos(phi), sin(phi));
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
    const float r = sqrt(fmax(0.0f, (1.0f - u.x) * (1.0f + u.x))), phi = 2.0f * PI * u.y;
    return (float3)(r * cos(phi), r * sin(phi), u.x);
}
