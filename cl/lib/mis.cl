// Multiple importance sampling. For one path or sixteen (lib/lanes.cl).

#include "lib/light_sample.cl"

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
#if defined(LIGHT_SAMPLING_LIGHT)
    return 1.0f;
#elif defined(LIGHT_SAMPLING_BSDF)
    return light->delta ? 1.0f : 0.0f;
#else
    return light->delta ? 1.0f : mis_weight(light->pdf, bsdf_pdf);
#endif
}
