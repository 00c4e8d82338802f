// The GGX microfacet distribution, anisotropic, with Smith's height-correlated shadowing and masking and sampling of the visible normals.
//
//   Walter, Marschner, Li & Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces": GGX, and refraction.
//   Heitz 2014, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs" (JCGT 3(2)): anisotropy, Λ, G1 and G2.
//   Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps": the sampling.
//   Burley 2012, "Physically-Based Shading at Disney", addenda: from roughness and anisotropy to α.
//
// Λ(w) = (A(w) / |w.z| − 1) / 2 with A(w) = |(αx wx, αy wy, wz)| (Heitz 2014, eq. 72 and 80). All that follows is written with A,
// which never divides by a cosine: the terms stay finite down to grazing angles, and tangents are never formed from 1 − cos².
// Every function takes |w.z|, so that it serves both sides of a surface.

#include "lib/circle.cl"
#include "lib/math.cl"

// Below this perceptual roughness (α = 10⁻⁴, a lobe of 0.006°) a surface is shaded as a smooth one: directions in single precision
// carry an error of about 10⁻⁷, so that slopes, and with them densities as high as 1 / πα², would be wrong by more than a part in 10³;
// and a lobe that narrow is below a pixel. Host side: lumiere.bsdf.SMOOTH_ROUGHNESS.
#define SMOOTH_ROUGHNESS 0.01f
#define SMOOTH_ALPHA (SMOOTH_ROUGHNESS * SMOOTH_ROUGHNESS)

// α along x and y: the scale of the slopes.
typedef struct {
    float x, y;
} ggx_t;

// α = roughness², stretched along x by anisotropy: αx / αy = 1 / (1 − 0.9 anisotropy) (Burley 2012, addenda).
static inline ggx_t ggx_new(float roughness, float anisotropy)
{
    const float r = clamp(roughness, SMOOTH_ROUGHNESS, 1.0f);
    const float aspect = sqrt(1.0f - 0.9f * clamp(anisotropy, 0.0f, 1.0f));
    ggx_t ggx;
    ggx.x = r * r / aspect;
    ggx.y = fmax(SMOOTH_ALPHA, r * r * aspect);
    return ggx;
}

// D(m): area of microfacets per unit of surface and of solid angle (Walter et al. 2007, eq. 33; stretched: Burley 2012, §B.2). m unit.
static inline float ggx_density(ggx_t ggx, float3 m)
{
    const float x = m.x / ggx.x, y = m.y / ggx.y;
    const float t = x * x + y * y + m.z * m.z;
    return 1.0f / (PI * ggx.x * ggx.y * t * t);
}

// A(w) = |(αx wx, αy wy, wz)|.
static inline float ggx_a(ggx_t ggx, float3 w)
{
    const float x = ggx.x * w.x, y = ggx.y * w.y;
    return sqrt(x * x + y * y + w.z * w.z);
}

// G1(wo) / |cosθo| = 2 / (|cosθo| + A(wo)).
static inline float ggx_g1_over_cos(ggx_t ggx, float3 wo)
{
    return 2.0f / (fabs(wo.z) + ggx_a(ggx, wo));
}

// G2(wo, wi) / (|cosθo| |cosθi|), heights correlated: G2 = 1 / (1 + Λ(wo) + Λ(wi)) (Heitz 2014, eq. 99).
static inline float ggx_g2_over_cos_cos(ggx_t ggx, float3 wo, float3 wi)
{
    return 2.0f / (ggx_a(ggx, wo) * fabs(wi.z) + ggx_a(ggx, wi) * fabs(wo.z));
}

// G2(wo, wi) / G1(wo): what is left of a sample's weight when its normal was a visible one.
static inline float ggx_g2_over_g1(ggx_t ggx, float3 wo, float3 wi)
{
    const float a_o = ggx_a(ggx, wo), a_i = ggx_a(ggx, wi), cos_o = fabs(wo.z), cos_i = fabs(wi.z);
    return cos_i * (cos_o + a_o) / (a_o * cos_i + a_i * cos_o);
}

// Density of the normals visible from wo: G1(wo) max(0, wo·m) D(m) / cosθo (PBR 4ed, §9.6.4). wo.z > 0.
static inline float ggx_visible_density(ggx_t ggx, float3 wo, float3 m)
{
    return ggx_g1_over_cos(ggx, wo) * fmax(0.0f, dot(wo, m)) * ggx_density(ggx, m);
}

// A normal with that density (Dupuy & Benyoub 2023, listing 3). wo.z > 0.
// A cap's point at height z = 1 − t has sin² = 1 − z² = t (2 − t), which keeps its digits for the small t of narrow lobes.
static inline float3 ggx_sample_visible(ggx_t ggx, float3 wo, float2 u)
{
    const float3 w = normalize((float3)(ggx.x * wo.x, ggx.y * wo.y, wo.z));  // to the hemisphere configuration, α = 1
    const float t = u.x * (1.0f + w.z);
    const float2 on_cap = sqrt(fmax(0.0f, t * (2.0f - t))) * circle_point(u.y);
    const float3 h = (float3)(on_cap + w.xy, (1.0f + w.z) * (1.0f - u.x));
    return normalize((float3)(ggx.x * h.x, ggx.y * h.y, fmax(0.0f, h.z)));
}
