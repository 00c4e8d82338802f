// Phong's glossy lobe about the mirror direction, over a Lambert base, normalised physically.
//
//   Lafortune & Willems 1994, "Using the Modified Phong Reflectance Model for Physically Based Rendering", eq. 2:
//   f = kd / π + ks (n + 2) / (2π) cosⁿα, α between wi and the mirror direction of wo.
//
// Reciprocal; reflects at most kd + ks, and exactly that at normal incidence. Where kd + ks exceeds 1 both are scaled down to it.

#include "bsdf/contract.cl"
#include "lib/circle.cl"
#include "lib/fresnel.cl"
#include "lib/math.cl"
#include "lib/warp.cl"

static inline float3 phong_scale(const phong_t *bsdf)
{
    return 1.0f / fmax((float3)(1.0f), bsdf->albedo + bsdf->specular);
}

// Probability of sampling the glossy lobe.
static inline float phong_glossy_probability(const phong_t *bsdf)
{
    const float diffuse = luminance(bsdf->albedo), glossy = luminance(bsdf->specular);
    return diffuse + glossy > 0.0f ? glossy / (diffuse + glossy) : 0.0f;
}

// cosⁿα from 1 − cosα = |wi − mirror|² / 2, for cosα itself has no digits left near 1, where a large n looks.
static inline float phong_cos_power(float exponent, float3 wo, float3 wi)
{
    const float3 difference = wi - (float3)(-wo.x, -wo.y, wo.z);
    const float one_minus_cos = 0.5f * dot(difference, difference);
    return one_minus_cos < 1.0f ? exp(exponent * log1p(-one_minus_cos)) : 0.0f;
}

static inline float3 phong_eval(const phong_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f)
        return (float3)(0.0f);
    const float n = fmax(0.0f, bsdf->exponent);
    const float glossy = 0.5f * (n + 2.0f) * phong_cos_power(n, wo, wi);
    return phong_scale(bsdf) * (bsdf->albedo + bsdf->specular * glossy) * (INV_PI * wi.z);
}

// Mixture of a cosine lobe and of (n + 1) / (2π) cosⁿα.
static inline float phong_pdf(const phong_t *bsdf, float3 wo, float3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f)
        return 0.0f;
    const float n = fmax(0.0f, bsdf->exponent), glossy_probability = phong_glossy_probability(bsdf);
    const float glossy = INV_TWO_PI * (n + 1.0f) * phong_cos_power(n, wo, wi);
    return mix(INV_PI * wi.z, glossy, glossy_probability);
}

static inline bsdf_sample_t phong_sample(const phong_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    if (wo.z <= 0.0f)
        return s;
    float3 wi;
    if (u.x < phong_glossy_probability(bsdf)) {
        // cosα = u^(1 / (n + 1)), and its sine without 1 − cos².
        const float log_cos = log1p(-u.y) / (fmax(0.0f, bsdf->exponent) + 1.0f);
        const float3 about_z = (float3)(sqrt(-expm1(2.0f * log_cos)) * circle_point(u.z), exp(log_cos));
        // Half a turn about the bisector of the normal and the mirror direction takes one to the other.
        wi = reflect_about(about_z, normalize((float3)(-wo.x, -wo.y, wo.z + 1.0f)));
    } else {
        wi = square_to_cosine_hemisphere(u.yz);
    }
    const float pdf = phong_pdf(bsdf, wo, wi);
    if (pdf <= 0.0f)
        return s;
    s.wi = wi;
    s.pdf = pdf;
    s.weight = phong_eval(bsdf, wo, wi) / pdf;
    return s;
}

static inline float3 phong_albedo(const phong_t *bsdf)
{
    return phong_scale(bsdf) * (bsdf->albedo + bsdf->specular);
}
