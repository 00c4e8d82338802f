// How much light GGX microfacets reflect, and the light that they lose because it meets them more than once.
//
// A single-scattering model's directional reflectance for F = 1, A(w), falls below 1. What is missing is given back as a diffuse lobe whose
// reflectance is exactly that (Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks"; Kelemen & Szirmay-Kalos 2001):
//
//   f = Fms (1 − A(wo)) (1 − A(wi)) / (π (1 − Ā)),    Fms = F̄² Ā / (1 − F̄ (1 − Ā))
//
// F̄ and Ā are averages over the hemisphere; Fms sums what the facets absorb at each further meeting (Hill & Conty, notes to the same course).
// A depends on direction and roughness through a table that tools/ggx_albedo.py makes.

#include "lib/ggx_albedo_table.cl"
#include "lib/math.cl"
#include "lib/microfacet.cl"

// Reflectance for Schlick's F: total (f0 + (f90 − f0) edge).
typedef struct {
    float total;
    float edge;
} ggx_albedo_t;

// s = √μ / (√μ + roughness √(1 − μ)): the tables' axis of cosines.
static inline float albedo_axis(float roughness, float mu)
{
    const float near = sqrt(mu), far = roughness * sqrt(fmax(0.0f, 1.0f - mu));
    return near / (near + far);
}

// Into a direction of cosine mu ≥ 0.
static inline ggx_albedo_t ggx_albedo(float roughness, float mu)
{
    const float r = clamp(roughness, SMOOTH_ROUGHNESS, 1.0f), cosine = clamp(mu, 0.0f, 1.0f);
    const float x = (float)(GGX_ALBEDO_COSINES - 1) * clamp(albedo_axis(r, cosine), 0.0f, 1.0f);
    const float y = (float)(GGX_ALBEDO_ROUGHNESSES - 1) * r;
    const int i = min((int)x, GGX_ALBEDO_COSINES - 2), j = min((int)y, GGX_ALBEDO_ROUGHNESSES - 2);
    constant const float2 *row = ggx_albedo_table + j * GGX_ALBEDO_COSINES + i;
    constant const float2 *next = row + GGX_ALBEDO_COSINES;
    const float2 t = mix(mix(row[0], row[1], x - (float)i), mix(next[0], next[1], x - (float)i), y - (float)j);
    const float c = clamp(1.0f - cosine - r * r / (r + 0.1f) * t.y, 0.0f, 1.0f), c2 = c * c;
    ggx_albedo_t albedo;
    albedo.total = clamp(t.x, 0.0f, 1.0f);
    albedo.edge = c2 * c2 * c;
    return albedo;
}

// The cosine-weighted average over the hemisphere.
static inline ggx_albedo_t ggx_albedo_average(float roughness)
{
    const float y = (float)(GGX_ALBEDO_ROUGHNESSES - 1) * clamp(roughness, SMOOTH_ROUGHNESS, 1.0f);
    const int j = min((int)y, GGX_ALBEDO_ROUGHNESSES - 2);
    const float2 t = mix(ggx_albedo_average_table[j], ggx_albedo_average_table[j + 1], y - (float)j);
    ggx_albedo_t albedo;
    albedo.total = t.x;
    albedo.edge = t.y / t.x;
    return albedo;
}

// The roughness that a stretched distribution shows towards w: that of its slopes along w.
static inline float ggx_roughness_along(ggx_t ggx, float3 w)
{
    const float x = ggx.x * w.x, y = ggx.y * w.y, length2 = w.x * w.x + w.y * w.y;
    return length2 > 0.0f ? sqrt(sqrt((x * x + y * y) / length2)) : sqrt(sqrt(ggx.x * ggx.y));
}

// Fms for Schlick's F with the given f0 and f90; average: Ā.
static inline float3 ggx_multiple_reflectance(float3 f0, float f90, float average)
{
    const float3 f = f0 + (f90 - f0) * (1.0f / 21.0f);
    return f * f * average / (1.0f - f * (1.0f - average));
}

// (1 − A(wo)) (1 − A(wi)) / (π (1 − Ā)), of the three reflectances for F = 1.
static inline float ggx_multiple_shape(float wo_total, float wi_total, float average)
{
    return (1.0f - wo_total) * (1.0f - wi_total) * INV_PI / fmax(1.0f - average, 1e-6f);
}
