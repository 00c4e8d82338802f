// Opacity: the fraction of rays that an object's surface stops.

#include "lib/math.cl"
#include "lib/surface.cl"
#include "scene/opacity.cl"

#ifdef OPACITY
static inline float object_opacity(const scene_t *scene, global const object_t *object, const surface_t *surface)
{
#ifdef TEXTURED_OPACITY
    if (object->opacity_texture != NO_TEXTURE)
        return texture_number(scene, object->opacity_texture, surface);
#endif
    return object->opacity;
}
#endif
