// A pane: two parallel smooth interfaces too close together to displace what passes, with all the reflections between them.
//
//   R' = R + T R T + T R³ T + … = 2R / (1 + R),  T' = 1 − R'   (Stokes 1860; PBR 4ed, §9.5.1)
//
// Both lobes are Dirac; what passes goes straight on, into the same medium.

#include "bsdf/contract.cl"
#include "lib/specular.cl"

static inline float3 thin_dielectric_eval(const thin_dielectric_t *bsdf, float3 wo, float3 wi)
{
    return (float3)(0.0f);
}

static inline float thin_dielectric_pdf(const thin_dielectric_t *bsdf, float3 wo, float3 wi)
{
    return 0.0f;
}

static inline bsdf_sample_t thin_dielectric_sample(const thin_dielectric_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = bsdf_sample_failed();
    if (wo.z == 0.0f)
        return s;
    float cos_t;
    const float single = fresnel_dielectric(fabs(wo.z), relative_ior(bsdf->ior, (float3)(0.0f, 0.0f, 1.0f)), &cos_t);
    const float reflectance = 2.0f * single / (1.0f + single);
    s.specular = 1;
    if (u.x < reflectance) {
        s.wi = (float3)(-wo.x, -wo.y, wo.z);
        s.weight = (float3)(1.0f);
        s.pdf = reflectance;
    } else {
        s.wi = -wo;
        s.weight = bsdf->transmittance;
        s.pdf = 1.0f - reflectance;
    }
    return s;
}

static inline float3 thin_dielectric_albedo(const thin_dielectric_t *bsdf)
{
    return bsdf->transmittance;
}
