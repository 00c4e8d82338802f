// Ray origins off a surface by the bound of the error with which the surface's point is known, not by a constant epsilon.
// Source: Pharr, Jakob & Humphreys, Physically Based Rendering 4ed, §6.8.6.

#include "lib/math.cl"

// The next float up, or down, from x, which is finite: nextafter, a slow call on some runtimes.
static inline float next_up(float x)
{
    const int bits = as_int(x);
    return x == 0.0f ? as_float(1) : as_float(bits + (bits > 0 ? 1 : -1));
}

static inline float next_down(float x)
{
    return -next_up(-x);
}

// The point p, known to within ±error, moved along the geometric normal to the side that w points to, so far that it is surely off the surface.
static inline float3 offset_origin(float3 p, float3 error, float3 normal, float3 w)
{
    float distance = dot(fabs(normal), error);
    float3 offset = distance * normal;
    if (dot(w, normal) < 0.0f)
        offset = -offset;
    float3 o = p + offset;
    // Rounding p + offset could bring it back: one more float away.
    o.x = offset.x > 0.0f ? next_up(o.x) : offset.x < 0.0f ? next_down(o.x) : o.x;
    o.y = offset.y > 0.0f ? next_up(o.y) : offset.y < 0.0f ? next_down(o.y) : o.y;
    o.z = offset.z > 0.0f ? next_up(o.z) : offset.z < 0.0f ? next_down(o.z) : o.z;
    return o;
}
