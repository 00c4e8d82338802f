// Rough glass: GGX microfacets, each a smooth interface that reflects or refracts.
//
//   Walter, Marschner, Li & Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces":
//   reflection (eq. 20)   f = F D G2 / (4 cosθo cosθi)                                     m ∝ wo + wi       (eq. 13)
//   refraction (eq. 21)   f = (1 − F) D G2 |wo·m| |wi·m| / (cosθo cosθi |wo + η wi|²)      m ∝ ±(wo + η wi)  (eq. 16)
//
// with η the index on wi's side over that on wo's, and eq. 21 in the form for radiance: it carries the factor 1 / η² of the change of
// medium (Veach 1997, §5.2). wo + η wi is along m, so that its squared length is the (wo·m + η wi·m)² of the paper.
// G2 is height-correlated on both sides (lib/microfacet.cl). The normal points out of the material: wo.z > 0 is outside.
// Light that meets a second facet is lost.

#include "bsdf/contract.cl"
#include "lib/fresnel.cl"
#include "lib/microfacet.cl"
#include "lib/specular.cl"

// Is the interface shaded as a smooth one? Where its roughness is (SMOOTH_ROUGHNESS says why), and where the indices are so alike that
// the refracted lobe, α |η − 1| wide, would be: there wo + η wi cancels, and leaves no digits for m.
static inline bool rough_dielectric_is_smooth(const rough_dielectric_t *bsdf)
{
    const float r = clamp(bsdf->roughness, 0.0f, 1.0f);
    return r < SMOOTH_ROUGHNESS || r * r * fabs(bsdf->ior - 1.0f) < SMOOTH_ALPHA;
}

// A pair of directions, seen from wo's side (which is turned to z > 0), with the facet's normal that connects them.
typedef struct {
    float3 wo, wi, m;
    float reflectance;  // Fresnel, at the facet
    float eta;          // index on wi's side over that on wo's, as if wi were refracted
    float jacobian;     // dm / dwi
    bool valid;         // does such a facet face both directions?
} rough_facet_t;

static inline rough_facet_t rough_dielectric_facet(const rough_dielectric_t *bsdf, float3 wo, float3 wi)
{
    rough_facet_t f;
    f.eta = relative_ior(bsdf->ior, wo);
    const float side = wo.z > 0.0f ? 1.0f : -1.0f;
    f.wo = (float3)(wo.x, wo.y, wo.z * side);
    f.wi = (float3)(wi.x, wi.y, wi.z * side);
    const bool reflected = f.wi.z > 0.0f;
    float3 m = reflected ? f.wo + f.wi : f.wo + f.eta * f.wi;
    const float length2 = dot(m, m);
    m *= rsqrt(length2);
    f.m = m.z < 0.0f ? -m : m;
    const float cos_o = dot(f.wo, f.m), cos_i = dot(f.wi, f.m);
    f.valid = f.wo.z > 0.0f && f.wi.z != 0.0f && length2 > 0.0f && cos_o > 0.0f && (reflected ? cos_i > 0.0f : cos_i < 0.0f);
    float cos_t;
    f.reflectance = fresnel_dielectric(clamp(cos_o, 0.0f, 1.0f), f.eta, &cos_t);
    f.jacobian = reflected ? 0.25f / cos_o : f.eta * f.eta * fabs(cos_i) / length2;  // eq. 14 and 17
    return f;
}

static inline float3 rough_dielectric_eval(const rough_dielectric_t *bsdf, float3 wo, float3 wi)
{
    const rough_facet_t f = rough_dielectric_facet(bsdf, wo, wi);
    if (!f.valid || rough_dielectric_is_smooth(bsdf))
        return (float3)(0.0f);
    const ggx_t ggx = ggx_new(bsdf->roughness, 0.0f);
    const float common_factor = ggx_density(ggx, f.m) * ggx_g2_over_cos_cos(ggx, f.wo, f.wi) * fabs(f.wi.z) * dot(f.wo, f.m) * f.jacobian;
    if (f.wi.z > 0.0f)
        return (float3)(f.reflectance * common_factor);
    return bsdf->transmittance * ((1.0f - f.reflectance) * common_factor / (f.eta * f.eta));
}

// Visible normals, then reflection with the probability F and refraction with 1 − F.
static inline float rough_dielectric_pdf(const rough_dielectric_t *bsdf, float3 wo, float3 wi)
{
    const rough_facet_t f = rough_dielectric_facet(bsdf, wo, wi);
    if (!f.valid || rough_dielectric_is_smooth(bsdf))
        return 0.0f;
    const float probability = f.wi.z > 0.0f ? f.reflectance : 1.0f - f.reflectance;
    return probability * ggx_visible_density(ggx_new(bsdf->roughness, 0.0f), f.wo, f.m) * f.jacobian;
}

static inline bsdf_sample_t rough_dielectric_sample(const rough_dielectric_t *bsdf, float3 wo, float3 u)
{
    if (rough_dielectric_is_smooth(bsdf))
        return interface_sample(bsdf->ior, bsdf->transmittance, wo, u.x);
    bsdf_sample_t s = bsdf_sample_failed();
    if (wo.z == 0.0f)
        return s;
    const ggx_t ggx = ggx_new(bsdf->roughness, 0.0f);
    const float eta = relative_ior(bsdf->ior, wo);
    const float3 above = (float3)(wo.x, wo.y, fabs(wo.z));
    const float3 m = ggx_sample_visible(ggx, above, u.yz);
    const float cos_o = clamp(dot(above, m), 0.0f, 1.0f);
    float cos_t;
    const float reflectance = fresnel_dielectric(cos_o, eta, &cos_t);
    const bool reflected = u.x < reflectance;
    float3 wi = reflected ? normalize(reflect_about(above, m)) : refract_through(above, m, cos_o, cos_t, eta);
    // A facet may send light to the side where it cannot come from: that is lost.
    if (reflected ? wi.z <= 0.0f : wi.z >= 0.0f)
        return s;
    const float g2_over_g1 = ggx_g2_over_g1(ggx, above, wi);
    wi.z *= wo.z > 0.0f ? 1.0f : -1.0f;
    s.pdf = rough_dielectric_pdf(bsdf, wo, wi);
    if (s.pdf <= 0.0f)
        return s;
    s.wi = wi;
    s.weight = reflected ? (float3)(g2_over_g1) : bsdf->transmittance * (g2_over_g1 / (eta * eta));
    s.eta = reflected ? 1.0f : eta;
    return s;
}

static inline float3 rough_dielectric_albedo(const rough_dielectric_t *bsdf)
{
    return bsdf->transmittance;
}
