// The ideal mirror: one Dirac lobe of the same reflectance at every angle.

#include "bsdf/contract.cl"

static inline float3 mirror_eval(const mirror_t *bsdf, float3 wo, float3 wi)
{
    return (float3)(0.0f);
}

static inline float mirror_pdf(const mirror_t *bsdf, float3 wo, float3 wi)
{
    return 0.0f;
}

static inline bsdf_sample_t mirror_sample(const mirror_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    if (wo.z <= 0.0f)
        return s;
    s.wi = (float3)(-wo.x, -wo.y, wo.z);
    s.weight = bsdf->reflectance;
    s.pdf = 1.0f;
    s.specular = 1;
    return s;
}

static inline float3 mirror_albedo(const mirror_t *bsdf)
{
    return bsdf->reflectance;
}
