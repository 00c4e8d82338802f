// Points of the unit circle, by plain arithmetic: the library's functions, made for angles of any size, took a quarter of shade's time on CPUs.
// For one path or sixteen (lib/lanes.cl).

#include "lib/math.cl"

// (cos t, sin t) for |t| ≤ π / 4: Taylor's series, off by less than a rounding.
static inline float2 circle_octant(float t)
{
    const float t2 = t * t;
    return float2_of(1.0f - t2 * (1.0f / 2.0f - t2 * (1.0f / 24.0f - t2 * (1.0f / 720.0f - t2 * (1.0f / 40320.0f)))),
                     t * (1.0f - t2 * (1.0f / 6.0f - t2 * (1.0f / 120.0f - t2 * (1.0f / 5040.0f - t2 * (1.0f / 362880.0f))))));
}

// (cos 2πu, sin 2πu) for u in [0, 1].
static inline float2 circle_point(float u)
{
    const uint quarter = convert_uint(4.0f * u + 0.5f);
    const float2 p = circle_octant((u - 0.25f * convert_float(quarter)) * (2.0f * PI));
    const bool odd = (quarter & 1u) != 0u, back = (quarter & 2u) != 0u;
    const float x = odd ? -p.y : p.x, y = odd ? p.x : p.y;
    return float2_of(back ? -x : x, back ? -y : y);
}
