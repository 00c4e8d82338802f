// Lambert's ideal diffuse reflection: f = albedo / π (Lambert 1760; PBR 4ed, §9.2).

#include "bsdf/contract.cl"
#include "lib/math.cl"
#include "lib/warp.cl"

static inline float3 lambert_eval(const lambert_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f)
        return (float3)(0.0f);
    return bsdf->albedo * (INV_PI * wi.z);
}

static inline float lambert_pdf(const lambert_t *bsdf, float3 wo, float3 wi)
{
    return wo.z <= 0.0f || wi.z <= 0.0f ? 0.0f : INV_PI * wi.z;
}

static inline bsdf_sample_t lambert_sample(const lambert_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    const float3 wi = square_to_cosine_hemisphere(u.yz);
    if (wo.z <= 0.0f || wi.z <= 0.0f)
        return s;
    s.wi = wi;
    s.weight = bsdf->albedo;
    s.pdf = INV_PI * wi.z;
    return s;
}

static inline float3 lambert_albedo(const lambert_t *bsdf)
{
    return bsdf->albedo;
}
