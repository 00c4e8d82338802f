// Normals tilted by a map.

#include "lib/frame_along.cl"
#include "lib/surface.cl"
#include "scene/tilt.cl"

#ifdef BENT_NORMALS
// The unit shading normal n turned towards the true one, g, so far that light from `to_viewer` can be mirrored away from the surface: one that
// cannot would be black where it should shine (Keller et al. 2017, "The Iray Light Transport Simulation and Rendering System", §A.3).
// g and the viewer are on one side.
static inline float3 bent_normal(float3 n, float3 g, float3 to_viewer)
{
    const float towards = dot(n, to_viewer);
    if (towards < 1e-3f)
        n = normalize(n + (1e-3f - towards) * to_viewer);  // faces the viewer, just
    const float3 mirrored = 2.0f * dot(n, to_viewer) * n - to_viewer;
    const float height = dot(mirrored, g), lowest = fmin(0.01f, 0.5f * dot(to_viewer, g));
    if (height >= lowest)
        return n;
    const float3 raised = mirrored + n * ((lowest - height) / fmax(dot(n, g), 1e-3f));
    const float3 along = raised - g * dot(raised, g);
    const float length2 = dot(along, along);
    return length2 > 1e-12f ? normalize(to_viewer + lowest * g + along * (sqrt(1.0f - lowest * lowest) * rsqrt(length2))) : g;
}
#endif

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
