// The smooth surface of a body that scatters inside: as smooth glass (lib/specular.cl), and what goes in walks in the medium.

#include "bsdf/contract.cl"
#include "lib/medium.cl"
#include "lib/specular.cl"

static inline float3 subsurface_eval(const subsurface_t *bsdf, float3 wo, float3 wi)
{
    return (float3)(0.0f);
}

static inline float subsurface_pdf(const subsurface_t *bsdf, float3 wo, float3 wi)
{
    return 0.0f;
}

static inline bsdf_sample_t subsurface_sample(const subsurface_t *bsdf, float3 wo, float3 u)
{
    bsdf_sample_t s = interface_sample(bsdf->ior, (float3)(1.0f), wo, u.x);
    s.walks = s.wi.z < 0.0f;
    return s;
}

static inline bool subsurface_in_body(const subsurface_t *bsdf, float3 wi)
{
    return wi.z < 0.0f;
}

static inline medium_t subsurface_medium(const subsurface_t *bsdf)
{
    return medium_of_color(bsdf->albedo, bsdf->radius, bsdf->g);
}

static inline float3 subsurface_albedo(const subsurface_t *bsdf)
{
    return bsdf->albedo;
}
