// Principled: metal, glass, and a glossy dielectric over a diffuse base, mixed, under a clear coat, under sheen.
//
//   Burley 2012, "Physically-Based Shading at Disney", and 2015, "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering":
//   the parameters. Andersson et al. 2024, OpenPBR 1.1: the layers. Estevez & Kulla 2017: sheen. Kulla & Conty 2017: what keeps the energy.
//
//   f = sheen + min(Ts(wo), Ts(wi)) coat + min(T(wo), T(wi)) (glossy + returned + glass) + base
//   base = c D(wo) D(wi) / (π D̄),    D(w) = T(w) (1 − E(w))
//
// Ts(w) is what the sheen leaves of the light from w, T(w) what sheen and coat leave, E(w) what the dielectric's gloss reflects of that, D̄ the
// cosine-weighted average of D. So the base gets, and at c = 1 gives back, all that is left: a white material reflects everything; what the
// minimum, which keeps the mixture reciprocal, withholds is lost. «returned» is what metal's facets lose (lib/ggx_albedo.cl); what the
// dielectric's lose goes to the base. Gloss and coat are GGX with Schlick's Fresnel reflectance: its reflectance is exactly tabulated.
//
// A fraction «subsurface» of the base scatters below: light goes in with D(wo), all of it and along a cosine, walks in a medium that reflects c
// (lib/medium.cl), and comes out with D(wi) / (π D̄), so that a body whose mean free path is 0 has the base's f. In and out, no index changes.
//
// A lobe that no material of the scene has is not compiled: PRINCIPLED_COAT, PRINCIPLED_SHEEN, PRINCIPLED_GLASS, WALKS.

#include "bsdf/contract.cl"
#include "lib/fresnel.cl"
#include "lib/ggx_albedo.cl"
#include "lib/math.cl"
#include "lib/medium.cl"
#include "lib/microfacet.cl"
#include "lib/rough_interface.cl"
#include "lib/sheen.cl"
#include "lib/warp.cl"

#define PRINCIPLED_COAT_F0 0.04f  // of index 1.5

// A material with the weights of its lobes, and what depends on the material alone.
typedef struct {
    ggx_t ggx;
    float roughness;      // of both of ggx's axes together
    float3 f0;            // of the gloss: metal's and dielectric's, each times its share
    float f90;
    float metal;          // shares
    float3 metal_f0;
    float3 dielectric_f0; // as if there were no metal
    float dielectric_f90;
    float3 base;          // c times the base's share
#ifdef PRINCIPLED_COAT
    ggx_t coat_ggx;
    float coat, coat_roughness;
#endif
#ifdef PRINCIPLED_SHEEN
    float3 sheen;
    float sheen_roughness;
#endif
#ifdef PRINCIPLED_GLASS
    float glass;
    rough_interface_t interface;
#endif
#ifdef WALKS
    float below;          // share of what scatters below the surface
#endif
} principled_lobes_t;

static inline principled_lobes_t principled_lobes(const principled_t *bsdf)
{
    principled_lobes_t lobes;
    const float3 color = clamp(bsdf->base_color, 0.0f, 1.0f);
    const float ior = fmax(bsdf->ior, 1e-3f);
    lobes.ggx = ggx_new(bsdf->roughness, bsdf->anisotropy);
    lobes.roughness = sqrt(sqrt(lobes.ggx.x * lobes.ggx.y));
    lobes.metal = clamp(bsdf->metallic, 0.0f, 1.0f);
    lobes.metal_f0 = color;
    float opaque = 1.0f - lobes.metal;
#ifdef PRINCIPLED_GLASS
    lobes.glass = opaque * clamp(bsdf->transmission, 0.0f, 1.0f);
    opaque -= lobes.glass;
    // Too near 1, the index leaves refraction no digits; and the lobe, α |ior − 1| wide, must not be narrower than they resolve.
    const float apart = clamp(fabs(ior - 1.0f), SMOOTH_ALPHA, 1e3f);
    lobes.interface.ior = ior < 1.0f ? 1.0f - fmin(apart, 0.999f) : 1.0f + apart;
    lobes.interface.roughness = clamp(fmax(bsdf->roughness, sqrt(SMOOTH_ALPHA / fmin(apart, 1.0f))), SMOOTH_ROUGHNESS, 1.0f);
    lobes.interface.transmittance = sqrt(color);  // twice crossed, the light has the base's colour (Burley 2015, §5.2)
#endif
    // Twice `specular` scales what the index reflects head on; below 2 %, which no solid has, the edge fades too (Lagarde & de Rousiers 2014, §3.2.1).
    const float n = (ior - 1.0f) / (ior + 1.0f);
    lobes.dielectric_f0 = clamp(2.0f * bsdf->specular * n * n * bsdf->specular_tint, 0.0f, 1.0f);
    lobes.dielectric_f90 = fmin(1.0f, 50.0f * max_component(lobes.dielectric_f0));
    lobes.f0 = lobes.metal * color + opaque * lobes.dielectric_f0;
    lobes.f90 = lobes.metal + opaque * lobes.dielectric_f90;
#ifdef WALKS
    lobes.below = opaque * clamp(bsdf->subsurface, 0.0f, 1.0f);
    opaque -= lobes.below;
#endif
    lobes.base = opaque * color;
#ifdef PRINCIPLED_COAT
    lobes.coat = clamp(bsdf->clearcoat, 0.0f, 1.0f);
    lobes.coat_roughness = clamp(bsdf->clearcoat_roughness, SMOOTH_ROUGHNESS, 1.0f);
    lobes.coat_ggx = ggx_new(bsdf->clearcoat_roughness, 0.0f);
#endif
#ifdef PRINCIPLED_SHEEN
    lobes.sheen = clamp(bsdf->sheen, 0.0f, 1.0f);
    lobes.sheen_roughness = bsdf->sheen_roughness;
#endif
    return lobes;
}

// What the layers leave of the light from a direction above.
typedef struct {
    ggx_albedo_t gloss;  // A and the edge of the gloss
    float3 under_sheen;  // Ts
    float3 under_coat;   // T
    float coat;          // the coat's own reflectance
    float sheen;
    float3 base;         // D
} principled_layers_t;

static inline float3 schlick_albedo(ggx_albedo_t albedo, float3 f0, float f90)
{
    return albedo.total * (f0 + (f90 - f0) * albedo.edge);
}

static inline principled_layers_t principled_layers(const principled_lobes_t *lobes, float roughness, float mu)
{
    principled_layers_t layers;
    layers.gloss = ggx_albedo(roughness, mu);
    layers.under_sheen = (float3)(1.0f);
    layers.sheen = 0.0f;
    layers.coat = 0.0f;
#ifdef PRINCIPLED_SHEEN
    layers.sheen = sheen_albedo(lobes->sheen_roughness, mu);
    layers.under_sheen -= lobes->sheen * layers.sheen;
#endif
    layers.under_coat = layers.under_sheen;
#ifdef PRINCIPLED_COAT
    layers.coat = lobes->coat * schlick_albedo(ggx_albedo(lobes->coat_roughness, mu), (float3)(PRINCIPLED_COAT_F0), 1.0f).x;
    layers.under_coat *= 1.0f - layers.coat;
#endif
    layers.base = layers.under_coat * (1.0f - schlick_albedo(layers.gloss, lobes->dielectric_f0, lobes->dielectric_f90));
    return layers;
}

static inline principled_layers_t principled_layers_along(const principled_lobes_t *lobes, float3 w)
{
    return principled_layers(lobes, ggx_roughness_along(lobes->ggx, w), w.z);
}

// D̄. Under a layer, a product of three functions: by Gauss–Jacobi quadrature for the weight 2μ, exact to the 7th degree.
static inline float3 principled_base_average(const principled_lobes_t *lobes)
{
#if defined(PRINCIPLED_COAT) || defined(PRINCIPLED_SHEEN)
    const float nodes[4] = {0.139759864f, 0.416409568f, 0.723156986f, 0.942895804f};
    const float weights[4] = {0.062361942f, 0.259695095f, 0.406929136f, 0.271013827f};
    float3 average = (float3)(0.0f);
    for (int i = 0; i < 4; ++i)
        average += weights[i] * principled_layers(lobes, lobes->roughness, nodes[i]).base;
    return average;
#else
    return 1.0f - schlick_albedo(ggx_albedo_average(lobes->roughness), lobes->dielectric_f0, lobes->dielectric_f90);
#endif
}

#ifdef ENERGY_COMPENSATION
static inline float3 principled_returned(const principled_lobes_t *lobes, float wo_total, float wi_total)
{
    const float average = ggx_albedo_average(lobes->roughness).total;
    return lobes->metal * ggx_multiple_reflectance(lobes->metal_f0, 1.0f, average) * ggx_multiple_shape(wo_total, wi_total, average);
}
#endif

// Probabilities of the lobes, seen from wo: their shares of what is scattered, from the layers' albedos.
typedef struct {
    float sheen, coat, gloss, base, glass, below;
} principled_choice_t;

static inline principled_choice_t principled_choice(const principled_lobes_t *lobes, const principled_layers_t *o)
{
    principled_choice_t p;
    p.sheen = p.coat = p.glass = p.below = 0.0f;
#ifdef PRINCIPLED_SHEEN
    p.sheen = luminance(lobes->sheen) * o->sheen;
#endif
#ifdef PRINCIPLED_COAT
    p.coat = luminance(o->under_sheen) * o->coat;
#endif
    p.gloss = luminance(o->under_coat * schlick_albedo(o->gloss, lobes->f0, lobes->f90));
    p.base = luminance(lobes->base * o->base);
#ifdef ENERGY_COMPENSATION
    p.base += lobes->metal * (1.0f - o->gloss.total) * luminance(lobes->metal_f0 * o->under_coat);
#endif
#ifdef PRINCIPLED_GLASS
    p.glass = lobes->glass * luminance(o->under_coat);
#endif
#ifdef WALKS
    p.below = lobes->below * luminance(o->base);
#endif
    const float sum = p.sheen + p.coat + p.gloss + p.base + p.glass + p.below;
    const float scale = sum > 0.0f ? 1.0f / sum : 0.0f;
    p.sheen *= scale;
    p.coat *= scale;
    p.gloss *= scale;
    p.base *= scale;
    p.glass *= scale;
    p.below *= scale;
    return p;
}

#ifdef WALKS
// Out of the body.
static inline float3 principled_out(const principled_lobes_t *lobes, float3 wi)
{
    return principled_layers_along(lobes, wi).base / fmax(principled_base_average(lobes), 1e-6f);
}
#endif

static inline float3 principled_eval(const principled_t *bsdf, float3 wo, float3 wi)
{
    const principled_lobes_t lobes = principled_lobes(bsdf);
    float3 f = (float3)(0.0f);
#ifdef WALKS
    if (bsdf->inside)
        return wi.z > 0.0f ? principled_out(&lobes, wi) * (INV_PI * wi.z) : f;
#endif
#ifdef PRINCIPLED_GLASS
    if (lobes.glass > 0.0f && wo.z != 0.0f && wi.z != 0.0f) {
        f = lobes.glass * rough_interface_eval(&lobes.interface, wo, wi);
        if (wo.z > 0.0f && wi.z < 0.0f)
            f *= principled_layers_along(&lobes, wo).under_coat;
        else if (wo.z < 0.0f && wi.z > 0.0f)
            f *= principled_layers_along(&lobes, wi).under_coat;
    }
#endif
    if (wo.z <= 0.0f || wi.z <= 0.0f)
        return f;
    const principled_layers_t o = principled_layers_along(&lobes, wo), i = principled_layers_along(&lobes, wi);
    const float3 m = normalize(wo + wi);
    const float k = clamp(1.0f - dot(wo, m), 0.0f, 1.0f), k2 = k * k, edge = k2 * k2 * k;
    float3 under = (lobes.f0 + (lobes.f90 - lobes.f0) * edge) * (0.25f * ggx_density(lobes.ggx, m) * ggx_g2_over_cos_cos(lobes.ggx, wo, wi));
#ifdef ENERGY_COMPENSATION
    under += principled_returned(&lobes, o.gloss.total, i.gloss.total);
#endif
    f = fmin(o.under_coat, i.under_coat) * (under * wi.z + f);
    f += lobes.base * o.base * i.base / fmax(principled_base_average(&lobes), 1e-6f) * (INV_PI * wi.z);
#ifdef PRINCIPLED_COAT
    f += fmin(o.under_sheen, i.under_sheen)
       * (lobes.coat * (PRINCIPLED_COAT_F0 + (1.0f - PRINCIPLED_COAT_F0) * edge)
          * (0.25f * ggx_density(lobes.coat_ggx, m) * ggx_g2_over_cos_cos(lobes.coat_ggx, wo, wi) * wi.z));
#endif
#ifdef PRINCIPLED_SHEEN
    f += lobes.sheen * sheen_eval(lobes.sheen_roughness, wo, wi);
#endif
    return f;
}

static inline float principled_pdf(const principled_t *bsdf, float3 wo, float3 wi)
{
#ifdef WALKS
    if (bsdf->inside)
        return fmax(INV_PI * wi.z, 0.0f);
#endif
    const principled_lobes_t lobes = principled_lobes(bsdf);
#ifdef PRINCIPLED_GLASS
    if (wo.z < 0.0f)
        return lobes.glass > 0.0f ? rough_interface_pdf(&lobes.interface, wo, wi) : 0.0f;
#endif
    if (wo.z <= 0.0f)
        return 0.0f;
    const principled_layers_t o = principled_layers_along(&lobes, wo);
    const principled_choice_t p = principled_choice(&lobes, &o);
    float pdf = 0.0f;
#ifdef PRINCIPLED_GLASS
    if (p.glass > 0.0f)
        pdf = p.glass * rough_interface_pdf(&lobes.interface, wo, wi);
#endif
    if (wi.z <= 0.0f)
        return pdf;
    const float3 m = normalize(wo + wi);
    pdf += p.gloss * 0.25f * ggx_g1_over_cos(lobes.ggx, wo) * ggx_density(lobes.ggx, m) + p.base * INV_PI * wi.z;
#ifdef PRINCIPLED_COAT
    pdf += p.coat * 0.25f * ggx_g1_over_cos(lobes.coat_ggx, wo) * ggx_density(lobes.coat_ggx, m);
#endif
#ifdef PRINCIPLED_SHEEN
    pdf += p.sheen * INV_TWO_PI;
#endif
    return pdf;
}

// The mirrored direction about a visible normal; z = 0 where it is below.
static inline float3 principled_mirrored(ggx_t ggx, float3 wo, float2 u)
{
    const float3 wi = normalize(reflect_about(wo, ggx_sample_visible(ggx, wo, u)));
    return wi.z > 0.0f ? wi : (float3)(1.0f, 0.0f, 0.0f);
}

// A direction from the lobe that u.x picks; z = 0 where it has none.
static inline float3 principled_direction(const principled_lobes_t *lobes, float3 wo, float3 u)
{
#ifdef PRINCIPLED_GLASS
    const float eta = relative_ior(lobes->interface.ior, wo);
    if (wo.z < 0.0f) {
        const interface_return_t back = rough_interface_return(&lobes->interface, eta, wo);
        const float3 wi = rough_interface_direction(&lobes->interface, &back, (float3)(wo.x, wo.y, -wo.z), eta, u);
        return (float3)(wi.x, wi.y, -wi.z);
    }
#endif
    const principled_layers_t o = principled_layers_along(lobes, wo);
    const principled_choice_t p = principled_choice(lobes, &o);
    float below = p.base;
    if (u.x < below)
        return square_to_cosine_hemisphere(u.yz);
#ifdef PRINCIPLED_COAT
    below += p.coat;
    if (u.x < below)
        return principled_mirrored(lobes->coat_ggx, wo, u.yz);
#endif
#ifdef PRINCIPLED_SHEEN
    below += p.sheen;
    if (u.x < below)
        return square_to_hemisphere(u.yz);
#endif
#ifdef PRINCIPLED_GLASS
    if (u.x < below + p.glass) {
        const interface_return_t back = rough_interface_return(&lobes->interface, eta, wo);
        return rough_interface_direction(&lobes->interface, &back, wo, eta, (float3)(clamp((u.x - below) / p.glass, 0.0f, 1.0f), u.y, u.z));
    }
#endif
    return principled_mirrored(lobes->ggx, wo, u.yz);
}

static inline bsdf_sample_t principled_sample(const principled_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
#ifdef WALKS
    if (bsdf->inside || wo.z > 0.0f) {
        const float3 along = square_to_cosine_hemisphere(u.yz);
        const principled_lobes_t lobes = principled_lobes(bsdf);
        if (bsdf->inside) {
            s.wi = along;
            s.pdf = INV_PI * along.z;
            s.weight = s.pdf > 0.0f ? principled_out(&lobes, along) : s.weight;
            return s;
        }
        const principled_layers_t o = principled_layers_along(&lobes, wo);
        const float below = principled_choice(&lobes, &o).below;
        if (u.x >= 1.0f - below) {  // behind the other lobes, which principled_direction has below that
            s.wi = (float3)(along.x, along.y, -along.z);
            s.pdf = below;
            s.weight = lobes.below * o.base / below;
            s.specular = 1;  // as a Dirac lobe, it is in neither eval nor pdf
            s.walks = 1;
            return s;
        }
    }
#endif
#ifdef PRINCIPLED_GLASS
    if (wo.z == 0.0f)
        return s;
#else
    if (wo.z <= 0.0f)
        return s;
#endif
    const principled_lobes_t lobes = principled_lobes(bsdf);
    const float3 wi = principled_direction(&lobes, wo, u);
    const float pdf = wi.z != 0.0f ? principled_pdf(bsdf, wo, wi) : 0.0f;
    if (pdf <= 0.0f)
        return s;
    s.wi = wi;
    s.pdf = pdf;
    s.weight = principled_eval(bsdf, wo, wi) / pdf;
#ifdef PRINCIPLED_GLASS
    if (wo.z * wi.z < 0.0f)
        s.eta = relative_ior(lobes.interface.ior, wo);
#endif
    return s;
}

#ifdef WALKS
static inline bool principled_in_body(const principled_t *bsdf, float3 wi)
{
    return false;  // eval has no such light
}

static inline medium_t principled_medium(const principled_t *bsdf)
{
    return medium_of_color(bsdf->base_color, bsdf->subsurface_radius, 0.0f);
}
#endif

static inline float3 principled_albedo(const principled_t *bsdf)
{
    return clamp(bsdf->base_color, 0.0f, 1.0f);
}
