// Smooth metal: one Dirac lobe, weighted with the Fresnel reflectance of the complex index eta + i k (lib/fresnel.cl).

#include "bsdf/contract.cl"
#include "lib/fresnel.cl"

static inline float3 conductor_eval(const conductor_t *bsdf, float3 wo, float3 wi)
{
    return (float3)(0.0f);
}

static inline float conductor_pdf(const conductor_t *bsdf, float3 wo, float3 wi)
{
    return 0.0f;
}

static inline bsdf_sample_t conductor_sample(const conductor_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    if (wo.z <= 0.0f)
        return s;
    s.wi = (float3)(-wo.x, -wo.y, wo.z);
    s.weight = fresnel_conductor(wo.z, bsdf->eta, bsdf->k);
    s.pdf = 1.0f;
    s.specular = 1;
    return s;
}

static inline float3 conductor_albedo(const conductor_t *bsdf)
{
    return fresnel_conductor(1.0f, bsdf->eta, bsdf->k);
}
