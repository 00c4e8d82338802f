// Ray origins off a surface by the bound of the error with which the surface's point is known, not by a constant epsilon.
// Source: Pharr, Jakob & Humphreys, Physically Based Rendering 4ed, §6.8.6.

#include "lib/math.cl"

// The point p, known to within ±error, moved along the geometric normal to the side that w points to, so far that it is surely off the surface.
static inline float3 offset_origin(float3 p, float3 error, float3 normal, float3 w)
{
    // In place of the next floats that PBR goes on to: what rounding the sum below may take back, of p at most 2⁻²⁴, and as much for the offset.
    float distance = dot(fabs(normal), error + 0x1p-23f * fabs(p));
    return p + (dot(w, normal) < 0.0f ? -distance : distance) * normal;
}
