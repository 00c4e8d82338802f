// Normals tilted by a map.

#include "lib/frame.cl"
#include "lib/surface.cl"
#include "scene/tilt.cl"

#ifdef NORMAL_MAP
// Tangent-space normals, red along dpdu, green along dpdv, blue along the normal (Peercy, Airey & Cabral 1997).
static inline float3 normal_mapped(const scene_t *scene, uint texture, const surface_t *surface)
{
    float3 n = 2.0f * texture_value(scene, texture, surface) - 1.0f;
    frame_t frame = frame_along(surface->ns, surface->dpdu);
    if (dot(frame.t, surface->dpdv) < 0.0f)
        frame.t = -frame.t;  // mirrored uv
    float3 tilted = frame_to_world(&frame, n);
    float length2 = dot(tilted, tilted);
    return length2 > 0.0f ? tilted * rsqrt(length2) : surface->ns;
}
#endif

#ifdef BUMP_MAP
#define BUMP_STEP 5e-4f  // of uv, as PBR 4ed, §10.5.2

// The normal of the surface raised by `scale` times the texture along its normal (Blinn 1978).
static inline float3 bump_mapped(const scene_t *scene, uint texture, float scale, const surface_t *surface)
{
    float height = texture_number(scene, texture, surface);
    surface_t beside = *surface;
    beside.uv.x += BUMP_STEP;
    float along_u = (texture_number(scene, texture, &beside) - height) * (scale / BUMP_STEP);
    beside.uv = surface->uv;
    beside.uv.y += BUMP_STEP;
    float along_v = (texture_number(scene, texture, &beside) - height) * (scale / BUMP_STEP);
    float3 n = cross(surface->dpdu + along_u * surface->ns, surface->dpdv + along_v * surface->ns);
    float length2 = dot(n, n);
    if (!(length2 > 0.0f))
        return surface->ns;
    n *= rsqrt(length2);
    return dot(n, surface->ns) < 0.0f ? -n : n;
}
#endif
