// What a surface that a path meets emits towards it.

#include "lib/emission.cl"
#include "lib/lights.cl"
#include "lib/path.cl"
#include "lib/samples.cl"

// Emission met by the path, weighed against light sampling.
static inline void add_emission(const scene_t *scene, const path_t *path, const samples_t *samples, uint slot, uint primitive,
                                global const object_t *object, const surface_t *surface, float3 direction, uint depth)
{
#ifdef EMISSION
    float3 radiance = emitted_radiance(scene, object->emission, surface, -direction);
    if (is_black(radiance))
        return;
    float weight = 1.0f;
#ifdef EMITTERS
    float bsdf_pdf = path_get_bsdf_pdf(path, slot);
    if (bsdf_pdf > 0.0f) {
        uint emitter = emitter_of(scene, primitive);
        float light_pdf = 0.0f;
        if (emitter < scene->render->emitter_count)
            light_pdf = discrete_probability(scene->light_cdf, emitter)
                      * emitter_pdf(scene, primitive, path_get_origin(path, slot), surface);
        weight = met_light_weight(bsdf_pdf, light_pdf);
    }
#endif
    sample_add_radiance(scene, samples, path_get_sample(path, slot), depth, path_get_throughput(path, slot) * radiance * weight);
#endif
}
