// The rough dielectric interface: GGX microfacets, each a smooth interface that reflects or refracts.
//
//   Walter, Marschner, Li & Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces":
//   reflection (eq. 20)   f = F D G2 / (4 cosθo cosθi)                                     m ∝ wo + wi       (eq. 13)
//   refraction (eq. 21)   f = (1 − F) D G2 |wo·m| |wi·m| / (cosθo cosθi |wo + η wi|²)      m ∝ ±(wo + η wi)  (eq. 16)
//
// with η the index on wi's side over that on wo's, and eq. 21 in the form for radiance: it carries the factor 1 / η² of the change of
// medium (Veach 1997, §5.2). wo + η wi is along m, so that its squared length is the (wo·m + η wi·m)² of the paper.
// G2 is height-correlated on both sides (lib/microfacet.cl). The normal points out of the material: wo.z > 0 is outside.
// Light that meets a second facet is lost, or with ENERGY_COMPENSATION given back diffusely (lib/interface_albedo.cl).

#include "bsdf/contract.cl"
#include "lib/fresnel.cl"
#include "lib/interface_albedo.cl"
#include "lib/microfacet.cl"
#include "lib/specular.cl"
#include "lib/warp.cl"

typedef struct {
    float ior;
    float roughness;
    float3 transmittance;
} rough_interface_t;

// Is the interface shaded as a smooth one? Where its roughness is (SMOOTH_ROUGHNESS says why), and where the indices are so alike that
// the refracted lobe, α |η − 1| wide, would be: there wo + η wi cancels, and leaves no digits for m.
static inline bool rough_interface_is_smooth(const rough_interface_t *interface)
{
    const float r = clamp(interface->roughness, 0.0f, 1.0f);
    return r < SMOOTH_ROUGHNESS || r * r * fabs(interface->ior - 1.0f) < SMOOTH_ALPHA;
}

// A pair of directions, seen from wo's side (which is turned to z > 0), with the facet's normal that connects them.
typedef struct {
    float3 wo, wi, m;
    float reflectance;  // Fresnel, at the facet
    float eta;          // index on wi's side over that on wo's, as if wi were refracted
    float jacobian;     // dm / dwi
    bool valid;         // does such a facet face both directions?
} rough_facet_t;

static inline rough_facet_t rough_interface_facet(const rough_interface_t *interface, float3 wo, float3 wi)
{
    rough_facet_t f;
    f.eta = relative_ior(interface->ior, wo);
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

// f |cosθi| of a rough interface, and the density of its sampling: visible normals, then reflection with the probability F and refraction with
// 1 − F; what is given back, by its share. `back` is that of wo's side.
static inline float3 rough_interface_scatter(const rough_interface_t *interface, const rough_facet_t *f, const interface_return_t *back, float *pdf)
{
    *pdf = 0.0f;
    if (f->wo.z <= 0.0f || f->wi.z == 0.0f)
        return (float3)(0.0f);
    const bool reflected = f->wi.z > 0.0f;
    float value = 0.0f;
    if (f->valid) {
        const ggx_t ggx = ggx_new(interface->roughness, 0.0f);
        value = (reflected ? f->reflectance : (1.0f - f->reflectance) / (f->eta * f->eta))
              * ggx_density(ggx, f->m) * ggx_g2_over_cos_cos(ggx, f->wo, f->wi) * fabs(f->wi.z) * dot(f->wo, f->m) * f->jacobian;
        *pdf = (reflected ? f->reflectance : 1.0f - f->reflectance) * ggx_visible_density(ggx, f->wo, f->m) * f->jacobian;
    }
#ifdef ENERGY_COMPENSATION
    const float lost = back->lost * INV_PI * fabs(f->wi.z);
    const float far_lost = interface_loss(interface->roughness, reflected ? f->eta : 1.0f / f->eta, fabs(f->wi.z));
    value += reflected ? (1.0f - back->crosses) * lost * far_lost / back->average
                       : back->crosses * lost * far_lost / (back->far_average * f->eta * f->eta);
    *pdf = (1.0f - back->lost) * *pdf + lost * (reflected ? 1.0f - back->crosses : back->crosses);
#endif
    return reflected ? (float3)(value) : interface->transmittance * value;
}

// What is given back, seen from wo.
static inline interface_return_t rough_interface_return(const rough_interface_t *interface, float eta, float3 wo)
{
#ifdef ENERGY_COMPENSATION
    return interface_return(interface->roughness, eta, fabs(wo.z));
#else
    const interface_return_t none = {0.0f, 1.0f, 1.0f, 0.0f};
    return none;
#endif
}

static inline float3 rough_interface_eval(const rough_interface_t *interface, float3 wo, float3 wi)
{
    const rough_facet_t f = rough_interface_facet(interface, wo, wi);
    const interface_return_t back = rough_interface_return(interface, f.eta, wo);
    float pdf;
    return rough_interface_scatter(interface, &f, &back, &pdf);
}

static inline float rough_interface_pdf(const rough_interface_t *interface, float3 wo, float3 wi)
{
    const rough_facet_t f = rough_interface_facet(interface, wo, wi);
    const interface_return_t back = rough_interface_return(interface, f.eta, wo);
    float pdf;
    rough_interface_scatter(interface, &f, &back, &pdf);
    return pdf;
}

// A direction that the facets send light from, wo being above; z = 0 where the facet would send it to the side where it cannot come from.
static inline float3 rough_interface_direction(const rough_interface_t *interface, const interface_return_t *back, float3 above, float eta, float3 u)
{
#ifdef ENERGY_COMPENSATION
    if (u.x < back->lost) {
        const float3 wi = square_to_cosine_hemisphere(u.yz);
        return u.x < back->lost * back->crosses ? (float3)(wi.x, wi.y, -wi.z) : wi;
    }
    u.x = (u.x - back->lost) / (1.0f - back->lost);
#endif
    const float3 m = ggx_sample_visible(ggx_new(interface->roughness, 0.0f), above, u.yz);
    const float cos_o = clamp(dot(above, m), 0.0f, 1.0f);
    float cos_t;
    const float reflectance = fresnel_dielectric(cos_o, eta, &cos_t);
    const bool reflected = u.x < reflectance;
    const float3 wi = reflected ? normalize(reflect_about(above, m)) : refract_through(above, m, cos_o, cos_t, eta);
    return (reflected ? wi.z > 0.0f : wi.z < 0.0f) ? wi : (float3)(1.0f, 0.0f, 0.0f);
}

static inline bsdf_sample_t rough_interface_sample(const rough_interface_t *interface, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    if (wo.z == 0.0f)
        return s;
    const float eta = relative_ior(interface->ior, wo);
    const interface_return_t back = rough_interface_return(interface, eta, wo);
    float3 wi = rough_interface_direction(interface, &back, (float3)(wo.x, wo.y, fabs(wo.z)), eta, u);
    if (wi.z == 0.0f)
        return s;
    const bool reflected = wi.z > 0.0f;
    wi.z *= wo.z > 0.0f ? 1.0f : -1.0f;
    const rough_facet_t f = rough_interface_facet(interface, wo, wi);
    float pdf;
    const float3 value = rough_interface_scatter(interface, &f, &back, &pdf);
    if (pdf <= 0.0f)
        return s;
    s.wi = wi;
    s.pdf = pdf;
    s.weight = value / pdf;
    s.eta = reflected ? 1.0f : eta;
    return s;
}
