// Smooth glass: a Dirac lobe of reflection and one of refraction, picked by the Fresnel reflectance (lib/specular.cl).
// The normal points out of the material: wo.z > 0 is outside.

#include "bsdf/contract.cl"
#include "lib/dispersion.cl"
#include "lib/specular.cl"

static inline float3 dielectric_eval(const dielectric_t *bsdf, float3 wo, float3 wi)
{
    return (float3)(0.0f);
}

static inline float dielectric_pdf(const dielectric_t *bsdf, float3 wo, float3 wi)
{
    return 0.0f;
}

static inline bsdf_sample_t dielectric_sample(const dielectric_t *bsdf, float3 wo, float3 u)
{
    const float3 tint = crossing_tint(bsdf->transmittance, bsdf->transmittance_distance);
#ifdef DISPERSION
    return dispersed_interface_sample(dispersed_iors(bsdf->ior, bsdf->dispersion, bsdf->spread), bsdf->share, tint, wo, u.x);
#else
    return interface_sample(bsdf->ior, tint, wo, u.x);
#endif
}

// What the body leaves of light that has crossed it.
static inline float3 dielectric_absorption(const dielectric_t *bsdf, float way)
{
    return absorption_tint(bsdf->transmittance, bsdf->transmittance_distance, way);
}

static inline float3 dielectric_albedo(const dielectric_t *bsdf)
{
    return bsdf->transmittance;
}
