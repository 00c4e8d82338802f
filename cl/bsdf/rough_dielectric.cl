// Rough glass: lib/rough_interface.cl, and where it is smooth, lib/specular.cl.

#include "bsdf/contract.cl"
#include "lib/rough_interface.cl"
#include "lib/specular.cl"

static inline rough_interface_t rough_dielectric_interface(const rough_dielectric_t *bsdf)
{
    rough_interface_t interface;
    interface.ior = bsdf->ior;
    interface.roughness = bsdf->roughness;
    interface.transmittance = crossing_tint(bsdf->transmittance, bsdf->transmittance_distance);
    return interface;
}

static inline float3 rough_dielectric_eval(const rough_dielectric_t *bsdf, float3 wo, float3 wi)
{
    const rough_interface_t interface = rough_dielectric_interface(bsdf);
    return rough_interface_is_smooth(&interface) ? (float3)(0.0f) : rough_interface_eval(&interface, wo, wi);
}

static inline float rough_dielectric_pdf(const rough_dielectric_t *bsdf, float3 wo, float3 wi)
{
    const rough_interface_t interface = rough_dielectric_interface(bsdf);
    return rough_interface_is_smooth(&interface) ? 0.0f : rough_interface_pdf(&interface, wo, wi);
}

static inline bsdf_sample_t rough_dielectric_sample(const rough_dielectric_t *bsdf, float3 wo, float3 u)
{
    const rough_interface_t interface = rough_dielectric_interface(bsdf);
    if (rough_interface_is_smooth(&interface))
        return interface_sample(bsdf->ior, interface.transmittance, wo, u.x);
    return rough_interface_sample(&interface, wo, u);
}

// What the body leaves of light that has crossed it.
static inline float3 rough_dielectric_absorption(const rough_dielectric_t *bsdf, float way)
{
    return absorption_tint(bsdf->transmittance, bsdf->transmittance_distance, way);
}

static inline float3 rough_dielectric_albedo(const rough_dielectric_t *bsdf)
{
    return bsdf->transmittance;
}
