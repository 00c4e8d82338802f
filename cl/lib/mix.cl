// Mixes: which of its parts a surface is, where a path meets it.

#include "lib/sampler.cl"
#include "lib/shapes.cl"
#include "scene/mix.cl"

#ifdef MIXES
#define NO_ROW 0xffffffffu

// The row of the object table that shades the meeting: the object's own or, as u in [0, 1) falls, that of a part. u serves all mixes in mixes.
static inline uint choose_part(const scene_t *scene, uint row, const ray_t *ray, const hit_t *hit, float u)
{
    if (scene->objects[row].mix_a == NO_ROW)
        return row;
#ifdef TEXTURED_MIXES
    const surface_t surface = surface_at(scene, ray, hit);
#endif
    while (scene->objects[row].mix_a != NO_ROW) {
        global const object_t *object = scene->objects + row;
        float weight = object->mix_weight;
#ifdef TEXTURED_MIXES
        if (object->mix_weight_texture != NO_TEXTURE)
            weight = clamp(texture_number(scene, object->mix_weight_texture, &surface), 0.0f, 1.0f);
#endif
        const bool second = u < weight;
        u = fmin(second ? u / weight : (u - weight) / (1.0f - weight), 1.0f - MACHINE_EPSILON);
        row = second ? object->mix_b : object->mix_a;
    }
    return row;
}
#endif
