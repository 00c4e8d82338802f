// Rough diffuse reflection that keeps its energy: EON, after Oren & Nayar's V-grooves (1994) in Fujii's form.
//
//   Portsmouth, Kutz & Hill 2025, "EON: A Practical Energy-Preserving Rough Diffuse BRDF" (JCGT 14(1)).
//
// f = f_ss + f_ms: grooves that scatter once (FON, Fujii's Oren–Nayar), and what they scatter more often, given back so that at albedo 1
// every direction reflects exactly all. roughness 0 is Lambert. Sampled by clipped linearly transformed cosines (CLTC, their §4) mixed
// with a uniform lobe, whose weights and coefficients are the paper's fits (listings 2 to 4).

#include "bsdf/contract.cl"
#include "lib/circle.cl"
#include "lib/math.cl"
#include "lib/warp.cl"

#define FON_C1 (0.5f - 2.0f / (3.0f * PI))           // makes the directional albedo 1 at the horizon (their listing 1)
#define FON_C2 (2.0f / 3.0f - 28.0f / (15.0f * PI))  // … and this gives its average over directions

// Directional albedo of the single-scattering lobe for albedo 1, exact (listing 1, E_FON_exact).
// (1 − sin³θ) / cosθ is written without the quotient, which is 0 / 0 at the horizon.
static inline float fon_albedo(float3 w, float roughness)
{
    const float mu = fmin(w.z, 1.0f), s = fmin(sqrt(w.x * w.x + w.y * w.y), 1.0f);
    const float g = s * (atan2(s, mu) - s * mu) + (2.0f / 3.0f) * (s * mu * (1.0f + s + s * s) / (1.0f + s) - s);
    return (1.0f + roughness * INV_PI * g) / (1.0f + FON_C1 * roughness);
}

static inline float3 oren_nayar_eval(const oren_nayar_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f)
        return (float3)(0.0f);
    const float r = clamp(bsdf->roughness, 0.0f, 1.0f);
    const float a = 1.0f / (1.0f + FON_C1 * r);

    // Single scattering, times cosθi: (1 + r s / t) cosθi with s = wi·wo − cosθi cosθo and t = max(cosθi, cosθo) where s > 0, else 1.
    const float s = wi.x * wo.x + wi.y * wo.y;
    const float cos_over_t = s > 0.0f ? wi.z / fmax(wi.z, wo.z) : wi.z;
    const float single = a * (wi.z + r * s * cos_over_t);

    // Multiple scattering: what single scattering lost towards wo and from wi, recoloured by the scattering in between.
    const float average = a * (1.0f + FON_C2 * r);
    const float lost_o = fmax(0.0f, 1.0f - fon_albedo(wo, r)), lost_i = fmax(0.0f, 1.0f - fon_albedo(wi, r));
    const float multiple = wi.z * lost_o * lost_i / fmax(1e-7f, 1.0f - average);
    const float3 albedo = bsdf->albedo;
    const float3 recoloured = albedo * albedo * average / (1.0f - albedo * (1.0f - average));
    return INV_PI * (albedo * fmax(0.0f, single) + recoloured * multiple);
}

// The transformation M of the cosine lobe, in the frame whose x axis is wo's azimuth (listing 2): rows (a 0 b), (0 c 0), (d 0 1).
typedef struct {
    float a, b, c, d;
} cltc_t;

static inline cltc_t cltc_new(float mu, float r)
{
    cltc_t m;
    m.a = 1.0f + r * (0.303392f + (-0.518982f + 0.111709f * mu) * mu + (-0.276266f + 0.335918f * mu) * r);
    m.b = r * (-1.16407f + 1.15859f * mu + (0.150815f - 0.150105f * mu) * r) / (mu * mu * mu - 1.43545f);
    m.c = 1.0f + (0.20013f + (-0.506373f + 0.261777f * mu) * mu) * r;
    m.d = r * (0.540852f + (-1.01625f + 0.475392f * mu) * mu) / (-1.0743f + mu * (0.0725628f + mu));
    return m;
}

// Fraction of the unit disk that is left of the cosine lobe where the transformation takes none of it below the horizon.
static inline float cltc_clipped_area(cltc_t m)
{
    return 0.5f * (1.0f + rsqrt(m.d * m.d + 1.0f));
}

// Probability of the uniform lobe (listing 4).
static inline float eon_uniform_probability(float mu, float r)
{
    return pow(r, 0.1f) * (0.162925f + mu * (-0.372058f + (0.538233f - 0.290822f * mu) * mu));
}

// Unit vector along wo's projection on the surface; any where wo is the normal.
static inline float2 azimuth_of(float3 w)
{
    const float length2 = w.x * w.x + w.y * w.y;
    return length2 > 0.0f ? w.xy * rsqrt(length2) : (float2)(1.0f, 0.0f);
}

static inline float oren_nayar_pdf(const oren_nayar_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f)
        return 0.0f;
    const float r = clamp(bsdf->roughness, 0.0f, 1.0f), mu = fmin(wo.z, 1.0f);
    const cltc_t m = cltc_new(mu, r);
    const float2 x = azimuth_of(wo);
    const float wi_x = wi.x * x.x + wi.y * x.y, wi_y = wi.y * x.x - wi.x * x.y;
    // Back through the adjugate of M, and the Jacobian of doing so (Heitz et al. 2016, eq. 1).
    const float determinant = m.c * (m.a - m.b * m.d);
    const float3 wh = (float3)(m.c * (wi_x - m.b * wi.z), (m.a - m.b * m.d) * wi_y, m.c * (m.a * wi.z - m.d * wi_x));
    const float jacobian = determinant / dot(wh, wh);
    const float transformed = jacobian * jacobian * fmax(0.0f, wh.z) * INV_PI / cltc_clipped_area(m);
    const float uniform_probability = eon_uniform_probability(mu, r);
    return uniform_probability * INV_TWO_PI + (1.0f - uniform_probability) * transformed;
}

static inline bsdf_sample_t oren_nayar_sample(const oren_nayar_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    if (wo.z <= 0.0f)
        return s;
    const float r = clamp(bsdf->roughness, 0.0f, 1.0f), mu = fmin(wo.z, 1.0f);
    float3 wi;
    if (u.x < eon_uniform_probability(mu, r)) {
        wi = square_to_hemisphere(u.yz);
    } else {
        const cltc_t m = cltc_new(mu, r);
        const float2 x = azimuth_of(wo);
        // Uniform over the disk's clipped shape, half a disk and half an ellipse (Heitz 2018, for visible normals), then lifted.
        const float2 in_disk = sqrt(u.y) * circle_point(u.z);
        const float disk_y = in_disk.y;
        const float disk_x = -mix(sqrt(fmax(0.0f, 1.0f - disk_y * disk_y)), in_disk.x, cltc_clipped_area(m));
        const float3 wh = (float3)(disk_x, disk_y, sqrt(fmax(0.0f, 1.0f - disk_x * disk_x - disk_y * disk_y)));
        const float3 w = normalize((float3)(m.a * wh.x + m.b * wh.z, m.c * wh.y, m.d * wh.x + wh.z));
        wi = (float3)(w.x * x.x - w.y * x.y, w.x * x.y + w.y * x.x, w.z);
    }
    const float pdf = oren_nayar_pdf(bsdf, wo, wi);
    if (pdf <= 0.0f)
        return s;
    s.wi = wi;
    s.pdf = pdf;
    s.weight = oren_nayar_eval(bsdf, wo, wi) / pdf;
    return s;
}

static inline float3 oren_nayar_albedo(const oren_nayar_t *bsdf)
{
    return bsdf->albedo;
}
