// A frame that is turned as a surface's tangents are.

#include "lib/frame.cl"

// A frame about n whose s lies along the tangent as far as it can; without a usable tangent, any.
static inline frame_t frame_along(float3 n, float3 tangent)
{
    float3 s = tangent - n * dot(n, tangent);
    float length2 = dot(s, s);
    if (!(length2 > 1e-20f * dot(tangent, tangent)))
        return frame_about(n);
    frame_t f;
    f.s = s * rsqrt(length2);
    f.t = cross(n, f.s);
    f.n = n;
    return f;
}
