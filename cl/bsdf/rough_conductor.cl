// Rough metal: GGX microfacets that mirror (Cook & Torrance 1981; Walter et al. 2007, eq. 20), with conductors' Fresnel reflectance.
//
//   f = F(wo·m) D(m) G2(wo, wi) / (4 cosθo cosθi),   m = (wo + wi) / |wo + wi|
//
// Light that meets a second facet is lost, as in all single-scattering models: little below α = 0.2, up to half at α = 1.
// The distribution and its sampling: lib/microfacet.cl.

#include "bsdf/contract.cl"
#include "lib/fresnel.cl"
#include "lib/microfacet.cl"

static inline bool rough_conductor_is_smooth(const rough_conductor_t *bsdf)
{
    return bsdf->roughness < SMOOTH_ROUGHNESS;
}

static inline float3 rough_conductor_eval(const rough_conductor_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f || rough_conductor_is_smooth(bsdf))
        return (float3)(0.0f);
    const ggx_t ggx = ggx_new(bsdf->roughness, bsdf->anisotropy);
    const float3 m = normalize(wo + wi);
    const float3 reflectance = fresnel_conductor(clamp(dot(wo, m), 0.0f, 1.0f), bsdf->eta, bsdf->k);
    return reflectance * (0.25f * ggx_density(ggx, m) * ggx_g2_over_cos_cos(ggx, wo, wi) * wi.z);
}

// Visible normals, mirrored: dm / dwi = 1 / (4 wo·m) (Walter et al. 2007, eq. 14), where wo·m cancels.
static inline float rough_conductor_pdf(const rough_conductor_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f || rough_conductor_is_smooth(bsdf))
        return 0.0f;
    const ggx_t ggx = ggx_new(bsdf->roughness, bsdf->anisotropy);
    return 0.25f * ggx_g1_over_cos(ggx, wo) * ggx_density(ggx, normalize(wo + wi));
}

static inline bsdf_sample_t rough_conductor_sample(const rough_conductor_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    if (wo.z <= 0.0f)
        return s;
    if (rough_conductor_is_smooth(bsdf)) {
        s.wi = (float3)(-wo.x, -wo.y, wo.z);
        s.weight = fresnel_conductor(wo.z, bsdf->eta, bsdf->k);
        s.pdf = 1.0f;
        s.specular = 1;
        return s;
    }
    const ggx_t ggx = ggx_new(bsdf->roughness, bsdf->anisotropy);
    const float3 m = ggx_sample_visible(ggx, wo, u.yz);
    const float3 wi = reflect_about(wo, m);
    if (wi.z <= 0.0f)
        return s;
    s.wi = normalize(wi);
    s.weight = fresnel_conductor(clamp(dot(wo, m), 0.0f, 1.0f), bsdf->eta, bsdf->k) * ggx_g2_over_g1(ggx, wo, s.wi);
    s.pdf = 0.25f * ggx_g1_over_cos(ggx, wo) * ggx_density(ggx, m);
    return s;
}

static inline float3 rough_conductor_albedo(const rough_conductor_t *bsdf)
{
    return fresnel_conductor(1.0f, bsdf->eta, bsdf->k);
}
