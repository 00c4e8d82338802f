// The rough surface of a body that scatters inside: as rough glass (lib/rough_interface.cl), and what goes in walks in the medium.

#include "bsdf/contract.cl"
#include "lib/medium.cl"
#include "lib/rough_interface.cl"
#include "lib/specular.cl"

static inline rough_interface_t rough_subsurface_interface(const rough_subsurface_t *bsdf)
{
    rough_interface_t interface;
    interface.ior = bsdf->ior;
    interface.roughness = bsdf->roughness;
    interface.transmittance = (float3)(1.0f);
    return interface;
}

static inline float3 rough_subsurface_eval(const rough_subsurface_t *bsdf, float3 wo, float3 wi)
{
    const rough_interface_t interface = rough_subsurface_interface(bsdf);
    return rough_interface_is_smooth(&interface) ? (float3)(0.0f) : rough_interface_eval(&interface, wo, wi);
}

static inline float rough_subsurface_pdf(const rough_subsurface_t *bsdf, float3 wo, float3 wi)
{
    const rough_interface_t interface = rough_subsurface_interface(bsdf);
    return rough_interface_is_smooth(&interface) ? 0.0f : rough_interface_pdf(&interface, wo, wi);
}

static inline bsdf_sample_t rough_subsurface_sample(const rough_subsurface_t *bsdf, float3 wo, float3 u)
{
    const rough_interface_t interface = rough_subsurface_interface(bsdf);
    bsdf_sample_t s = rough_interface_is_smooth(&interface) ? interface_sample(bsdf->ior, interface.transmittance, wo, u.x)
                                                            : rough_interface_sample(&interface, wo, u);
    s.walks = s.wi.z < 0.0f;
    return s;
}

static inline bool rough_subsurface_in_body(const rough_subsurface_t *bsdf, float3 wi)
{
    return wi.z < 0.0f;
}

static inline medium_t rough_subsurface_medium(const rough_subsurface_t *bsdf)
{
    return medium_of_color(bsdf->albedo, bsdf->radius, bsdf->g);
}

static inline float3 rough_subsurface_albedo(const rough_subsurface_t *bsdf)
{
    return bsdf->albedo;
}
