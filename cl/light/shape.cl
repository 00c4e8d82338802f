// Shapes that emit, as lights: scene->emitters lists their primitives in ascending order.

#include "lib/emission.cl"
#include "lib/offset.cl"
#include "lib/shapes.cl"

static inline light_sample_t emitter_sample(const scene_t *scene, uint emitter, float3 reference, uint2 u)
{
    uint primitive = scene->emitters[emitter];
    float2 at = (float2)(unit_float(u.x), unit_float(u.y));
    light_point_t point;
    point.pdf = 0.0f;
#define SAMPLE_OF(NAME) \
    if (primitive - scene->render->NAME##_first < scene->render->NAME##_count) \
        point = NAME##_sample(scene, primitive - scene->render->NAME##_first, reference, at);
    FOR_EACH_SHAPE(SAMPLE_OF)
    if (!(point.pdf > 0.0f))
        return light_sample_new(reference, (float3)(0.0f), 0.0f, 0, 0);
    float3 to_reference = reference - point.surface.p;
    float3 radiance = emitted_radiance(scene, scene->objects[scene->primitive_objects[primitive]].emission, &point.surface, to_reference);
    float3 target = offset_origin(point.surface.p, point.surface.error, point.surface.ng, to_reference);
    return light_sample_new(target, radiance, point.pdf, 0, 0);
}

// Density over solid angle at `reference` with which the point of `primitive` is chosen by its shape's sampling.
static inline float emitter_pdf(const scene_t *scene, uint primitive, float3 reference, const surface_t *surface)
{
#define PDF_OF(NAME) \
    if (primitive - scene->render->NAME##_first < scene->render->NAME##_count) \
        return NAME##_sample_pdf(scene, primitive - scene->render->NAME##_first, reference, surface);
    FOR_EACH_SHAPE(PDF_OF)
    return 0.0f;
}

// The place of `primitive` among the emitters, or the number of emitters where it is none of them.
static inline uint emitter_of(const scene_t *scene, uint primitive)
{
    uint low = 0u, high = scene->render->emitter_count;
    while (low < high) {
        uint middle = (low + high) >> 1;
        if (scene->emitters[middle] < primitive)
            low = middle + 1u;
        else
            high = middle;
    }
    return low < scene->render->emitter_count && scene->emitters[low] == primitive ? low : scene->render->emitter_count;
}
