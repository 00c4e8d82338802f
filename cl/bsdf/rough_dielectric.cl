// Rough glass: lib/rough_interface.cl, and where it is smooth, lib/specular.cl.
//
// With DISPERSION each channel has an interface of its own; directions come from that of one of them, and their density is that of all, by the
// channels' shares (Veach & Guibas 1995: the balance heuristic), so that every channel keeps what it scatters that way.

#include "bsdf/contract.cl"
#include "lib/dispersion.cl"
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

#ifdef DISPERSION
static inline rough_interface_t rough_dielectric_interface_at(const rough_interface_t *interface, float ior)
{
    rough_interface_t other = *interface;
    other.ior = ior;
    return other;
}

static inline float3 rough_dielectric_dispersed_eval(const rough_interface_t *interface, float3 iors, float3 wo, float3 wi)
{
    const rough_interface_t red = rough_dielectric_interface_at(interface, iors.x), green = rough_dielectric_interface_at(interface, iors.y),
                            blue = rough_dielectric_interface_at(interface, iors.z);
    return (float3)(rough_interface_eval(&red, wo, wi).x, rough_interface_eval(&green, wo, wi).y, rough_interface_eval(&blue, wo, wi).z);
}

static inline float rough_dielectric_dispersed_pdf(const rough_interface_t *interface, float3 iors, float3 share, float3 wo, float3 wi)
{
    const rough_interface_t red = rough_dielectric_interface_at(interface, iors.x), green = rough_dielectric_interface_at(interface, iors.y),
                            blue = rough_dielectric_interface_at(interface, iors.z);
    return dot(share, (float3)(rough_interface_pdf(&red, wo, wi), rough_interface_pdf(&green, wo, wi), rough_interface_pdf(&blue, wo, wi)));
}
#endif

static inline float3 rough_dielectric_eval(const rough_dielectric_t *bsdf, float3 wo, float3 wi)
{
    const rough_interface_t interface = rough_dielectric_interface(bsdf);
    if (rough_interface_is_smooth(&interface))
        return (float3)(0.0f);
#ifdef DISPERSION
    return rough_dielectric_dispersed_eval(&interface, dispersed_iors(bsdf->ior, bsdf->dispersion, bsdf->spread), wo, wi);
#else
    return rough_interface_eval(&interface, wo, wi);
#endif
}

static inline float rough_dielectric_pdf(const rough_dielectric_t *bsdf, float3 wo, float3 wi)
{
    const rough_interface_t interface = rough_dielectric_interface(bsdf);
    if (rough_interface_is_smooth(&interface))
        return 0.0f;
#ifdef DISPERSION
    return rough_dielectric_dispersed_pdf(&interface, dispersed_iors(bsdf->ior, bsdf->dispersion, bsdf->spread), bsdf->share, wo, wi);
#else
    return rough_interface_pdf(&interface, wo, wi);
#endif
}

static inline bsdf_sample_t rough_dielectric_sample(const rough_dielectric_t *bsdf, float3 wo, float3 u)
{
    const rough_interface_t interface = rough_dielectric_interface(bsdf);
#ifdef DISPERSION
    const float3 iors = dispersed_iors(bsdf->ior, bsdf->dispersion, bsdf->spread);
    if (rough_interface_is_smooth(&interface))
        return dispersed_interface_sample(iors, bsdf->share, interface.transmittance, wo, u.x);
    float lobe = u.x;
    const int channel = dispersion_pick(bsdf->share, &lobe);
    const rough_interface_t picked = rough_dielectric_interface_at(&interface, channel_of(iors, channel));
    u.x = lobe;
    bsdf_sample_t s = rough_interface_sample(&picked, wo, u);
    if (s.pdf > 0.0f) {
        s.pdf = rough_dielectric_dispersed_pdf(&interface, iors, bsdf->share, wo, s.wi);
        s.weight = rough_dielectric_dispersed_eval(&interface, iors, wo, s.wi) / s.pdf;
    }
    return s;
#else
    if (rough_interface_is_smooth(&interface))
        return interface_sample(bsdf->ior, interface.transmittance, wo, u.x);
    return rough_interface_sample(&interface, wo, u);
#endif
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
