// The smooth dielectric interface: two Dirac lobes, reflection and refraction. Shared by glass that is smooth everywhere and by
// rough glass where its roughness vanishes.

#include "bsdf/contract.cl"
#include "lib/fresnel.cl"

// Index on the far side over that on wo's: the surface's normal points out of the material of index ior.
// Beyond these bounds, which nothing transparent reaches, an interface reflects nearly everything and its square would overflow.
static inline float relative_ior(float ior, float3 wo)
{
    const float bounded = clamp(ior, 1e-3f, 1e3f);
    return wo.z > 0.0f ? bounded : 1.0f / bounded;
}

// The tint at a crossing: none where the light is tinted on its way.
static inline float3 crossing_tint(float3 transmittance, float transmittance_distance)
{
    return transmittance_distance > 0.0f ? (float3)(1.0f) : transmittance;
}

// What is left of light that has gone so far inside (Beer's law): `transmittance` after `transmittance_distance`.
static inline float3 absorption_tint(float3 transmittance, float transmittance_distance, float way)
{
    return transmittance_distance > 0.0f ? pow(transmittance, (float3)(way / transmittance_distance)) : (float3)(1.0f);
}

// One of the two lobes, picked with the Fresnel reflectance. Refracted radiance is scaled by 1 / η² (Veach 1997, §5.2).
static inline bsdf_sample_t interface_sample(float ior, float3 transmittance, float3 wo, float u)
{
    if (wo.z == 0.0f)
        return bsdf_sample_failed();
    bsdf_sample_t s;
    s.specular = 1;
    const float eta = relative_ior(ior, wo);
    float cos_t;
    const float reflectance = fresnel_dielectric(fabs(wo.z), eta, &cos_t);
    if (u < reflectance) {
        s.wi = (float3)(-wo.x, -wo.y, wo.z);
        s.weight = (float3)(1.0f);
        s.pdf = reflectance;
        s.eta = 1.0f;
    } else {
        s.wi = normalize((float3)(-wo.x / eta, -wo.y / eta, -copysign(cos_t, wo.z)));
        s.weight = transmittance / (eta * eta);
        s.pdf = 1.0f - reflectance;
        s.eta = eta;
    }
    return s;
}
