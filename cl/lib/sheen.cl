// Sheen: the fuzz of cloth, fibres that stand up and shine at grazing angles.
//
//   f = D(h) / (4 (cosθo + cosθi − cosθo cosθi)),    D(h) = (2 + 1/α) sin^(1/α) θh / 2π,    α = roughness²
//
// D is Charlie (Estevez & Kulla 2017, "Production Friendly Microfacet Sheen BRDF", eq. 2), the denominator that of Neubelt & Pettineo 2013
// ("Crafting a Next-Gen Material Pipeline for The Order: 1886"), as KHR_materials_sheen has both. Smooth sheen reflects more than it receives
// at grazing angles: it is divided by the larger of the two directions' reflectances where that exceeds 1, which keeps it reciprocal.

#include "lib/math.cl"
#include "lib/sheen_albedo_table.cl"

// E(w) before that division.
static inline float sheen_raw_albedo(float roughness, float mu)
{
    const float x = (float)(SHEEN_COSINES - 1) * sqrt(clamp(mu, 0.0f, 1.0f));
    const float y = (float)(SHEEN_ROUGHNESSES - 1) * clamp((roughness - SMALLEST_SHEEN_ROUGHNESS) / (1.0f - SMALLEST_SHEEN_ROUGHNESS), 0.0f, 1.0f);
    const int i = min((int)x, SHEEN_COSINES - 2), j = min((int)y, SHEEN_ROUGHNESSES - 2);
    constant const float *row = sheen_table + j * SHEEN_COSINES + i;
    return mix(mix(row[0], row[1], x - (float)i), mix(row[SHEEN_COSINES], row[SHEEN_COSINES + 1], x - (float)i), y - (float)j);
}

// What sheen reflects of the light from a direction of cosine mu: never less than it really does.
static inline float sheen_albedo(float roughness, float mu)
{
    return fmin(1.0f, sheen_raw_albedo(roughness, mu));
}

// f |cosθi|. wo.z, wi.z > 0.
static inline float sheen_eval(float roughness, float3 wo, float3 wi)
{
    const float r = clamp(roughness, SMALLEST_SHEEN_ROUGHNESS, 1.0f), inverse = 1.0f / (r * r);
    const float3 h = normalize(wo + wi);
    const float density = (2.0f + inverse) * pow(fmax(0.0f, h.x * h.x + h.y * h.y), 0.5f * inverse) * INV_TWO_PI;
    const float excess = fmax(1.0f, fmax(sheen_raw_albedo(r, wo.z), sheen_raw_albedo(r, wi.z)));
    return density * wi.z / (4.0f * (wo.z + wi.z - wo.z * wi.z) * excess);
}
