// Points of the unit circle, by plain arithmetic: the library's functions, made for angles of any size, took a quarter of shade's time on CPUs.

#include "lib/math.cl"

// (cos t, sin t) for |t| ≤ π / 4: Taylor's series, off by less than a rounding.
static inline float2 circle_octant(float t)
{
    const float t2 = t * t;
    return (float2)(1.0f - t2 * (1.0f / 2.0f - t2 * (1.0f / 24.0f - t2 * (1.0f / 720.0f - t2 * (1.0f / 40320.0f)))),
                    t * (1.0f - t2 * (1.0f / 6.0f - t2 * (1.0f / 120.0f - t2 * (1.0f / 5040.0f - t2 * (1.0f / 362880.0f))))));
}

// (cos 2πu, sin 2πu) for u in [0, 1].
static inline float2 circle_point(float u)
{
    const float quarter = floor(4.0f * u + 0.5f);
    const float2 p = circle_octant((u - 0.25f * quarter) * (2.0f * PI));
    const uint turns = (uint)quarter;
    const float2 q = (turns & 1u) != 0u ? (float2)(-p.y, p.x) : p;
    return (turns & 2u) != 0u ? -q : q;
}
