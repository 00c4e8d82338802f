// Choosing and sampling a light. Lights are numbered: emitting primitives first, then kind after kind. scene->light_cdf says how likely each is chosen.

#include "lib/discrete.cl"
#include "lib/frame.cl"
#include "lib/light_sample.cl"
#include "lib/math.cl"
#include "scene/lights.cl"

// A light by u.x, then a direction or point of it by what the choice leaves of u.x, and by u.y: so the lights together are stratified in two dimensions.
// (On a light of probability p that leaves steps of 2⁻³² / p.) The pdf includes the choice.
static inline light_sample_t light_sample(const scene_t *scene, float3 reference, uint2 u)
{
    discrete_t chosen = discrete_sample(scene->light_cdf, scene->render->light_count, u.x);
    u.x = chosen.rest;
    light_sample_t s = light_sample_new(reference, (float3)(0.0f), 0.0f, 0, 0);
#ifdef EMITTERS
    if (chosen.index < scene->render->emitter_count)
        s = emitter_sample(scene, chosen.index, reference, u);
#endif
#define SAMPLE_LIGHT(NAME) \
    if (chosen.index - scene->render->NAME##_light_first < scene->render->NAME##_light_count) \
        s = NAME##_sample(scene, chosen.index - scene->render->NAME##_light_first, reference, u);
    FOR_EACH_LIGHT(SAMPLE_LIGHT)
    s.pdf *= chosen.probability;
    return s;
}

// Weight of a technique against one other, of densities pdf and other (power heuristic with exponent 2, Veach 1997, eq. 9.11).
static inline float mis_weight(float pdf, float other)
{
    float ratio = other / pdf;
    return 1.0f / (1.0f + ratio * ratio);
}

// Weight of light met by a ray whose direction was drawn with density bsdf_pdf (0: by a camera or a specular lobe, which light sampling cannot do),
// where light sampling would have had density light_pdf.
static inline float met_light_weight(float bsdf_pdf, float light_pdf)
{
#if defined(LIGHT_SAMPLING_LIGHT)
    return bsdf_pdf > 0.0f && light_pdf > 0.0f ? 0.0f : 1.0f;
#elif defined(LIGHT_SAMPLING_BSDF)
    return 1.0f;
#else
    return bsdf_pdf > 0.0f ? mis_weight(bsdf_pdf, light_pdf) : 1.0f;
#endif
}

// Weight of a sampled light, of density light_pdf, where sampling the BSDF would have had bsdf_pdf.
static inline float sampled_light_weight(const light_sample_t *light, float bsdf_pdf)
{
    if (light->delta)
        return 1.0f;
#if defined(LIGHT_SAMPLING_LIGHT)
    return 1.0f;
#elif defined(LIGHT_SAMPLING_BSDF)
    return 0.0f;
#else
    return mis_weight(light->pdf, bsdf_pdf);
#endif
}
