// Plastic: a rough dielectric coat (GGX) over a Lambert base, coupled so that nothing is lost between them.
//
//   f = f_coat + T(wo) T(wi) / π · a / (η² (1 − a) + a T̄)
//
// f_coat = F D G2 / (4 cosθo cosθi) (Walter et al. 2007, eq. 20); T(w) = 1 − E(w): what the coat does not reflect of light from w
// passes to the base, and what the base sends up is let through as reciprocity asks: T(w) / η² (Veach 1997, §5.2). Some of it is
// reflected back down inside, 1 − T̄ / η² on average, again and again, each time losing 1 − a to the base (a: albedo): summed up, that
// is the fraction above. It is the coupling of Ashikhmin, Premože & Shirley 2000 and of Kelemen & Szirmay-Kalos 2001, with the internal
// reflection of Jakob's roughplastic (Mitsuba, `nonlinear`). At a = 1 every direction reflects all.
//
// Without ENERGY_COMPENSATION what meets a second facet is lost: of the light from outside L(w), T(w) = 1 − E(w) − L(w), of that from inside
// L̄′ on average, which adds a η² L̄′ to the denominator.
//
// E and the average T̄ come from a table, tools/plastic_coat.py; L from lib/interface_albedo.cl.

#include "bsdf/contract.cl"
#include "bsdf/plastic_table.cl"
#include "lib/fresnel.cl"
#include "lib/interface_albedo.cl"
#include "lib/math.cl"
#include "lib/microfacet.cl"
#include "lib/warp.cl"

// What depends on the material alone.
typedef struct {
    ggx_t ggx;
    float ior, roughness;
    bool smooth;      // the coat is a Dirac lobe
    float4 average;   // interpolation between the table's indices: of T̄,
    float3 kappa;     // and of κ
} plastic_coat_t;

// Weights of the values at three and at four nodes for the polynomial through them, at x (Lagrange).
static inline float3 interpolate3(float3 n, float x)
{
    const float3 d = x - n;
    return (float3)(d.y * d.z / ((n.x - n.y) * (n.x - n.z)), d.x * d.z / ((n.y - n.x) * (n.y - n.z)),
                    d.x * d.y / ((n.z - n.x) * (n.z - n.y)));
}

static inline float4 interpolate4(float4 n, float x)
{
    const float4 d = x - n;
    return (float4)(d.y * d.z * d.w / ((n.x - n.y) * (n.x - n.z) * (n.x - n.w)), d.x * d.z * d.w / ((n.y - n.x) * (n.y - n.z) * (n.y - n.w)),
                    d.x * d.y * d.w / ((n.z - n.x) * (n.z - n.y) * (n.z - n.w)), d.x * d.y * d.z / ((n.w - n.x) * (n.w - n.y) * (n.w - n.z)));
}

static inline plastic_coat_t plastic_coat_new(const plastic_t *bsdf)
{
    plastic_coat_t coat;
    coat.ior = clamp(bsdf->ior, 1.0f, 2.5f);
    coat.roughness = clamp(bsdf->roughness, 0.0f, 1.0f);
    coat.smooth = coat.roughness < SMOOTH_ROUGHNESS;
    coat.ggx = ggx_new(coat.roughness, 0.0f);
    const float s = (coat.ior - 1.0f) / (coat.ior + 1.0f);
    coat.kappa = interpolate3(PLASTIC_KAPPA_NODES, cbrt(s));
    coat.average = interpolate4(PLASTIC_AVERAGE_NODES, s);
    return coat;
}

// E(w) = A F(c): see the head of tools/plastic_coat.py.
static inline float plastic_coat_reflectance(const plastic_coat_t *coat, float mu)
{
    float cos_t;
    if (coat->smooth)
        return fresnel_dielectric(mu, coat->ior, &cos_t);
    const float alpha = coat->roughness * coat->roughness;
    const float x = (float)(PLASTIC_TABLE_V - 1) * clamp(mu / (mu + alpha * (1.0f - mu)), 0.0f, 1.0f);
    const float y = (float)(PLASTIC_TABLE_ROUGHNESS - 1) * coat->roughness;
    const int i = min((int)x, PLASTIC_TABLE_V - 2), j = min((int)y, PLASTIC_TABLE_ROUGHNESS - 2);
    constant const float4 *row = plastic_table + j * PLASTIC_TABLE_V + i;
    constant const float4 *next = row + PLASTIC_TABLE_V;
    const float4 t = mix(mix(row[0], row[1], x - (float)i), mix(next[0], next[1], x - (float)i), y - (float)j);
    const float c = mu + alpha / (coat->roughness + 0.1f) * dot(t.yzw, coat->kappa);
    return t.x * fresnel_dielectric(clamp(c, 0.0f, 1.0f), coat->ior, &cos_t);
}

// T(w), from E(w).
static inline float plastic_coat_transmittance(const plastic_coat_t *coat, float mu, float reflectance)
{
#ifdef ENERGY_COMPENSATION
    return 1.0f - reflectance;
#else
    return coat->smooth ? 1.0f - reflectance : fmax(0.0f, 1.0f - reflectance - interface_loss(coat->roughness, coat->ior, mu));
#endif
}

// T̄.
static inline float plastic_coat_average_transmittance(const plastic_coat_t *coat)
{
    const float y = (float)(PLASTIC_TABLE_ROUGHNESS - 1) * coat->roughness;
    const int j = min((int)y, PLASTIC_TABLE_ROUGHNESS - 2);
    const float average = dot(mix(plastic_average_table[j], plastic_average_table[j + 1], y - (float)j), coat->average);
#ifdef ENERGY_COMPENSATION
    return average;
#else
    return coat->smooth ? average : fmax(0.0f, average - interface_loss_average(coat->roughness, coat->ior));
#endif
}

// The base as seen through the coat, over T(wo) T(wi) cosθi / π.
static inline float3 plastic_base(const plastic_t *bsdf, const plastic_coat_t *coat)
{
    const float3 a = bsdf->albedo;
    const float ior2 = coat->ior * coat->ior;
    float inside = plastic_coat_average_transmittance(coat);
#ifndef ENERGY_COMPENSATION
    inside += coat->smooth ? 0.0f : ior2 * interface_loss_average(coat->roughness, 1.0f / coat->ior);
#endif
    return a / (ior2 * (1.0f - a) + a * inside);
}

// Probability of sampling the coat: its share of what is reflected towards wo.
static inline float plastic_coat_probability(const plastic_t *bsdf, const plastic_coat_t *coat, float mu, float reflectance)
{
    const float base = plastic_coat_transmittance(coat, mu, reflectance) * plastic_coat_average_transmittance(coat) * luminance(plastic_base(bsdf, coat));
    return reflectance + base > 0.0f ? reflectance / (reflectance + base) : 0.0f;
}

static inline float3 plastic_eval(const plastic_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f)
        return (float3)(0.0f);
    const plastic_coat_t coat = plastic_coat_new(bsdf);
    const float through = plastic_coat_transmittance(&coat, wo.z, plastic_coat_reflectance(&coat, wo.z))
                        * plastic_coat_transmittance(&coat, wi.z, plastic_coat_reflectance(&coat, wi.z));
    float3 f = plastic_base(bsdf, &coat) * (through * INV_PI * wi.z);
    if (!coat.smooth) {
        const float3 m = normalize(wo + wi);
        float cos_t;
        const float reflectance = fresnel_dielectric(clamp(dot(wo, m), 0.0f, 1.0f), coat.ior, &cos_t);
        f += 0.25f * reflectance * ggx_density(coat.ggx, m) * ggx_g2_over_cos_cos(coat.ggx, wo, wi) * wi.z;
    }
    return f;
}

static inline float plastic_pdf(const plastic_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f)
        return 0.0f;
    const plastic_coat_t coat = plastic_coat_new(bsdf);
    const float coat_probability = plastic_coat_probability(bsdf, &coat, wo.z, plastic_coat_reflectance(&coat, wo.z));
    float pdf = (1.0f - coat_probability) * INV_PI * wi.z;
    if (!coat.smooth)
        pdf += coat_probability * 0.25f * ggx_g1_over_cos(coat.ggx, wo) * ggx_density(coat.ggx, normalize(wo + wi));
    return pdf;
}

static inline bsdf_sample_t plastic_sample(const plastic_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    if (wo.z <= 0.0f)
        return s;
    const plastic_coat_t coat = plastic_coat_new(bsdf);
    const float reflectance = plastic_coat_reflectance(&coat, wo.z);
    const float coat_probability = plastic_coat_probability(bsdf, &coat, wo.z, reflectance);
    const bool coat_picked = u.x < coat_probability;
    if (coat_picked && coat.smooth) {
        s.wi = (float3)(-wo.x, -wo.y, wo.z);
        s.weight = (float3)(reflectance / coat_probability);
        s.pdf = coat_probability;
        s.specular = 1;
        return s;
    }
    const float3 wi =
        coat_picked ? normalize(reflect_about(wo, ggx_sample_visible(coat.ggx, wo, u.yz))) : square_to_cosine_hemisphere(u.yz);
    const float pdf = plastic_pdf(bsdf, wo, wi);
    if (pdf <= 0.0f)
        return s;
    s.wi = wi;
    s.pdf = pdf;
    s.weight = plastic_eval(bsdf, wo, wi) / pdf;
    return s;
}

static inline float3 plastic_albedo(const plastic_t *bsdf)
{
    return bsdf->albedo;
}
