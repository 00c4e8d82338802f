// Dispersion in three channels: each sees light of wavelengths about its primary's, and the index depends on the wavelength.
//
//   n(λ) − 1 = (nd − 1) (1 + D (1/λ² − 1/λd²)),   D = 1 / (V (1/λF² − 1/λC²))     (Cauchy's two terms by the Abbe number V; Born & Wolf 1999, §2.3.4)
//
// with Fraunhofer's lines F, d and C. A sample of the picture has one wavelength for each channel: where a smooth surface refracts them apart, the
// path goes on with one channel, picked by its share of what the path carries, and so divided by it (Wilkie et al. 2014 call it the hero).
// Which one the path has is told by what it carries. Between rough facets the channels keep together.

#include "bsdf/contract.cl"
#include "lib/math.cl"
#include "lib/specular.cl"

// The wavelength, µm, at u of a channel whose sensitivity rises from `low` to `peak` and falls to `high`: the inverse of its CDF.
static inline float tent_wavelength(float u, float low, float peak, float high)
{
    const float width = high - low, rise = peak - low, fall = high - peak;
    return u * width < rise ? low + sqrt(u * width * rise) : high - sqrt((1.0f - u) * width * fall);
}

// 1/λ² − 1/λd², µm⁻², of the three channels at u: tents between the dominant wavelengths of Rec. 709's primaries, 611, 549 and 464 nm.
static inline float3 dispersion_spread(float u)
{
    const float3 w = (float3)(tent_wavelength(u, 0.549f, 0.611f, 0.700f), tent_wavelength(u, 0.464f, 0.549f, 0.611f),
                              tent_wavelength(u, 0.400f, 0.464f, 0.549f));
    return 1.0f / (w * w) - 1.0f / (0.58756f * 0.58756f);
}

// The channels' indices. Below 1 it is what is around the body that disperses.
static inline float3 dispersed_iors(float ior, float dispersion, float3 spread)
{
    const float n = clamp(ior, 1e-3f, 1e3f);
    const float3 stretched = 1.0f + ((n < 1.0f ? 1.0f / n : n) - 1.0f) * fmax(1.0f + dispersion * spread, 0.0f);
    return dispersion == 0.0f ? (float3)(ior) : n < 1.0f ? 1.0f / stretched : stretched;
}

// A channel picked by its share, and u made a random number of its own again.
static inline int dispersion_pick(float3 share, float *u)
{
    const float below_y = share.x, below_z = share.x + share.y;
    int channel = *u < below_y ? 0 : *u < below_z ? 1 : 2;
    if (channel == 2 && share.z <= 0.0f)  // the shares' sum is 1 but for rounding
        channel = share.y > 0.0f ? 1 : 0;
    const float first = channel == 0 ? 0.0f : channel == 1 ? below_y : below_z;
    const float width = channel == 0 ? share.x : channel == 1 ? share.y : share.z;
    *u = clamp((*u - first) / width, 0.0f, 1.0f - MACHINE_EPSILON);
    return channel;
}

static inline float channel_of(float3 values, int channel)
{
    return channel == 0 ? values.x : channel == 1 ? values.y : values.z;
}

// interface_sample (lib/specular.cl), of channels of different index: reflection is the same for all, refraction takes one of them.
static inline bsdf_sample_t dispersed_interface_sample(float3 iors, float3 share, float3 transmittance, float3 wo, float u)
{
    if (iors.x == iors.y && iors.y == iors.z)
        return interface_sample(iors.y, transmittance, wo, u);
    const int channel = dispersion_pick(share, &u);
    bsdf_sample_t s = interface_sample(channel_of(iors, channel), transmittance, wo, u);
    if (s.pdf <= 0.0f)
        return s;
    if (s.wi.z * wo.z > 0.0f) {
        float cos_t;
        const float3 reflectance = (float3)(fresnel_dielectric(fabs(wo.z), relative_ior(iors.x, wo), &cos_t),
                                            fresnel_dielectric(fabs(wo.z), relative_ior(iors.y, wo), &cos_t),
                                            fresnel_dielectric(fabs(wo.z), relative_ior(iors.z, wo), &cos_t));
        s.pdf = dot(share, reflectance);
        s.weight = select((float3)(0.0f), reflectance / s.pdf, share > 0.0f);
    } else {
        const float part = channel_of(share, channel);
        s.pdf *= part;
        s.weight *= (float3)(channel == 0, channel == 1, channel == 2) / part;
    }
    return s;
}
