// Ray origins off a surface by the bound of the error with which the surface's point is known, not by a constant epsilon.
// Source: Pharr, Jakob & Humphreys, Physically Based Rendering 4ed, §6.8.6. For one path or sixteen (lib/lanes.cl).

#include "lib/math.cl"

// The point p, known to within ±error, moved along the geometric normal to the side that w points to, so far that it is surely off the surface.
static inline float3 offset_origin(float3 p, float3 error, float3 normal, float3 w)
{
    // In place of the next floats that PBR goes on to: what rounding the sum below may take back, of p at most 2⁻²⁴, and as much for the offset.
    const float distance = dot3(absolute3(normal), add3(error, scale3(absolute3(p), 0x1p-23f)));
    return add3(p, scale3(normal, dot3(w, normal) < 0.0f ? -distance : distance));
}
