// What surfaces emit.

#include "lib/surface.cl"
#include "lib/math.cl"
#include "scene/emission.cl"

#ifdef EMISSION
// Radiance that a surface with the given emission sends in direction w (away from it).
static inline float3 emitted_radiance(const scene_t *scene, int emission, const surface_t *surface, float3 w)
{
    if (emission < 0)
        return (float3)(0.0f);
    global const emission_t *record = scene->emissions + emission;
    if (!record->both_sides && dot(surface->ng, w) <= 0.0f)
        return (float3)(0.0f);
    float3 radiance = load3(record->radiance);
#ifdef TEXTURED_EMISSION
    if (record->texture != NO_TEXTURE)
        radiance = texture_value(scene, record->texture, surface);
#endif
    return radiance;
}
#endif
