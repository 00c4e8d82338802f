// Rough metal: GGX microfacets that mirror (Cook & Torrance 1981; Walter et al. 2007, eq. 20), with conductors' Fresnel reflectance.
//
//   f = F(wo·m) D(m) G2(wo, wi) / (4 cosθo cosθi),   m = (wo + wi) / |wo + wi|
//
// Light that meets a second facet is lost, as in all single-scattering models: 1 % at α = 0.1, over half at α = 1. With ENERGY_COMPENSATION
// it is given back diffusely (lib/ggx_albedo.cl). The distribution and its sampling: lib/microfacet.cl.

#include "bsdf/contract.cl"
#include "lib/fresnel.cl"
#include "lib/ggx_albedo.cl"
#include "lib/microfacet.cl"
#include "lib/warp.cl"

static inline bool rough_conductor_is_smooth(const rough_conductor_t *bsdf)
{
    return bsdf->roughness < SMOOTH_ROUGHNESS;
}

#ifdef ENERGY_COMPENSATION
// A(w), and the probability of sampling what is given back: its share.
static inline float rough_conductor_total(ggx_t ggx, float3 w)
{
    return ggx_albedo(ggx_roughness_along(ggx, w), w.z).total;
}

static inline float3 rough_conductor_returned(const rough_conductor_t *bsdf, ggx_t ggx, float3 wo, float3 wi)
{
    const float average = ggx_albedo_average(sqrt(sqrt(ggx.x * ggx.y))).total;
    return ggx_multiple_reflectance(fresnel_conductor(1.0f, bsdf->eta, bsdf->k), 1.0f, average)
         * ggx_multiple_shape(rough_conductor_total(ggx, wo), rough_conductor_total(ggx, wi), average);
}
#endif

static inline float3 rough_conductor_eval(const rough_conductor_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f || rough_conductor_is_smooth(bsdf))
        return (float3)(0.0f);
    const ggx_t ggx = ggx_new(bsdf->roughness, bsdf->anisotropy);
    const float3 m = normalize(wo + wi);
    const float3 reflectance = fresnel_conductor(clamp(dot(wo, m), 0.0f, 1.0f), bsdf->eta, bsdf->k);
    float3 f = reflectance * (0.25f * ggx_density(ggx, m) * ggx_g2_over_cos_cos(ggx, wo, wi));
#ifdef ENERGY_COMPENSATION
    f += rough_conductor_returned(bsdf, ggx, wo, wi);
#endif
    return f * wi.z;
}

// Visible normals, mirrored: dm / dwi = 1 / (4 wo·m) (Walter et al. 2007, eq. 14), where wo·m cancels.
static inline float rough_conductor_pdf(const rough_conductor_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f || rough_conductor_is_smooth(bsdf))
        return 0.0f;
    const ggx_t ggx = ggx_new(bsdf->roughness, bsdf->anisotropy);
    float pdf = 0.25f * ggx_g1_over_cos(ggx, wo) * ggx_density(ggx, normalize(wo + wi));
#ifdef ENERGY_COMPENSATION
    pdf = mix(INV_PI * wi.z, pdf, rough_conductor_total(ggx, wo));
#endif
    return pdf;
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
#ifdef ENERGY_COMPENSATION
    const bool mirrored = u.x < rough_conductor_total(ggx, wo);
#else
    const bool mirrored = true;
#endif
    const float3 wi = mirrored ? normalize(reflect_about(wo, ggx_sample_visible(ggx, wo, u.yz))) : square_to_cosine_hemisphere(u.yz);
    const float pdf = rough_conductor_pdf(bsdf, wo, wi);
    if (pdf <= 0.0f)
        return s;
    s.wi = wi;
    s.pdf = pdf;
    s.weight = rough_conductor_eval(bsdf, wo, wi) / pdf;
    return s;
}

static inline float3 rough_conductor_albedo(const rough_conductor_t *bsdf)
{
    return fresnel_conductor(1.0f, bsdf->eta, bsdf->k);
}
