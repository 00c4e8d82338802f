// Lambert's ideal diffuse reflection: f = albedo / π (Lambert 1760; PBR 4ed, §9.2). For one path or sixteen (lib/lanes.cl).

#include "bsdf/contract.cl"
#include "lib/math.cl"
#include "lib/warp.cl"

static inline float lambert_pdf(const lambert_t *bsdf, float3 wo, float3 wi)
{
    return wo.z <= 0.0f || wi.z <= 0.0f ? 0.0f : INV_PI * wi.z;
}

static inline float3 lambert_eval(const lambert_t *bsdf, float3 wo, float3 wi)
{
    return scale3(bsdf->albedo, lambert_pdf(bsdf, wo, wi));
}

static inline bsdf_sample_t lambert_sample(const lambert_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    s.wi = square_to_cosine_hemisphere(float2_of(u.y, u.z));
    s.pdf = lambert_pdf(bsdf, wo, s.wi);
    s.weight = scale3(bsdf->albedo, s.pdf > 0.0f ? 1.0f : 0.0f);
    return s;
}

static inline float3 lambert_albedo(const lambert_t *bsdf)
{
    return bsdf->albedo;
}
