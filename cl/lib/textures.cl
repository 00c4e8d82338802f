// The texture with the given id: its kind's number << 24 | its index.

#include "lib/math.cl"
#include "lib/surface.cl"
#include "scene/textures.cl"

#define TEXTURE_CASE(number, NAME) \
    case number: \
        return NAME##_texture(scene, id & 0xffffffu, surface);

static inline float3 texture_value(const scene_t *scene, uint id, const surface_t *surface)
{
    switch (id >> 24) {
    FOR_EACH_TEXTURE(TEXTURE_CASE)
    }
    return (float3)(0.0f);
}

// What a number takes from a texture: its mean channel.
static inline float texture_number(const scene_t *scene, uint id, const surface_t *surface)
{
    float3 value = texture_value(scene, id, surface);
    return (value.x + value.y + value.z) / 3.0f;
}
