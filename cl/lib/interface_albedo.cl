// What a rough interface between dielectrics loses after one scattering, and what it gives back: lib/ggx_albedo.cl for both of its sides.
//
//   reflected   f = (1 − T) L(wo) L(wi) / (π L̄)          refracted   f = T L(wo) L′(wi) / (π L̄′ η²)
//
// L is the loss for light from wo's side, L′ from the other, L̄ and L̄′ their averages (Kulla & Conty 2017). T, the part of what is given back
// that crosses, is free but for reciprocity, T L̄ = η² T′ L̄′: T = (1 − F̄) L̄′ / max(L̄, L̄′), since 1 − F̄ = η² (1 − F̄′).

#include "lib/ggx_albedo.cl"
#include "lib/interface_albedo_table.cl"
#include "lib/math.cl"

// Where η lies on the tables' axis of y = (1 − min(η, 1/η))^(3/8): *row is the first of the two rows, the value how far it is to the next.
static inline float interface_axis(float eta, int *row)
{
    const bool below = eta < 1.0f;
    const int rows = below ? INTERFACE_LOSS_BELOW : INTERFACE_LOSS_ABOVE;
    const float quarter = sqrt(sqrt(clamp(1.0f - (below ? eta : 1.0f / eta), 0.0f, 1.0f)));
    const float y = (float)(rows - 1) * quarter * sqrt(quarter);
    const int k = min((int)y, rows - 2);
    *row = below ? k : INTERFACE_LOSS_BELOW + k;
    return y - (float)k;
}

// L for light of cosine mu ≥ 0 from the side where eta is the far side's index over the near side's.
static inline float interface_loss(float roughness, float eta, float mu)
{
    const float r = clamp(roughness, SMOOTH_ROUGHNESS, 1.0f);
    const float x = (float)(INTERFACE_LOSS_COSINES - 1) * clamp(albedo_axis(r, clamp(mu, 0.0f, 1.0f)), 0.0f, 1.0f);
    const float y = (float)(INTERFACE_LOSS_ROUGHNESSES - 1) * r;
    const int i = min((int)x, INTERFACE_LOSS_COSINES - 2), j = min((int)y, INTERFACE_LOSS_ROUGHNESSES - 2);
    int k;
    const float fx = x - (float)i, fy = y - (float)j, fz = interface_axis(eta, &k);
    constant const ushort *t = interface_loss_table + (k * INTERFACE_LOSS_ROUGHNESSES + j) * INTERFACE_LOSS_COSINES + i;
    const int up = INTERFACE_LOSS_COSINES, beyond = INTERFACE_LOSS_ROUGHNESSES * INTERFACE_LOSS_COSINES;
    const float near_row = mix(mix((float)t[0], (float)t[1], fx), mix((float)t[up], (float)t[up + 1], fx), fy);
    t += beyond;
    const float far_row = mix(mix((float)t[0], (float)t[1], fx), mix((float)t[up], (float)t[up + 1], fx), fy);
    return mix(near_row, far_row, fz) * (1.0f / 65535.0f);
}

// L̄.
static inline float interface_loss_average(float roughness, float eta)
{
    const float y = (float)(INTERFACE_LOSS_ROUGHNESSES - 1) * clamp(roughness, SMOOTH_ROUGHNESS, 1.0f);
    const int j = min((int)y, INTERFACE_LOSS_ROUGHNESSES - 2);
    int k;
    const float fy = y - (float)j, fz = interface_axis(eta, &k);
    constant const ushort *t = interface_loss_average_table + k * INTERFACE_LOSS_ROUGHNESSES + j;
    const int up = INTERFACE_LOSS_ROUGHNESSES;
    return mix(mix((float)t[0], (float)t[1], fy), mix((float)t[up], (float)t[up + 1], fy), fz) * (1.0f / 65535.0f);
}

// 1 − F̄, the average transmittance of a smooth interface (fit of Kulla & Conty 2017 for η ≥ 1; below it, 1 − F̄(1/η) = (1 − F̄(η)) / η²).
static inline float interface_average_transmittance(float eta)
{
    const float n = eta >= 1.0f ? eta : 1.0f / eta;
    const float t = 1.0f - (n - 1.0f) / (4.08567f + 1.00071f * n);
    return eta >= 1.0f ? t : t / (n * n);
}

// What is given back, seen from a side and along a direction.
typedef struct {
    float lost;         // L
    float average;      // L̄ of this side
    float far_average;  // L̄′
    float crosses;      // T
} interface_return_t;

static inline interface_return_t interface_return(float roughness, float eta, float mu)
{
    interface_return_t back;
    back.lost = interface_loss(roughness, eta, mu);
    back.average = fmax(interface_loss_average(roughness, eta), 1e-6f);
    back.far_average = fmax(interface_loss_average(roughness, 1.0f / eta), 1e-6f);
    back.crosses = interface_average_transmittance(eta) * back.far_average / fmax(back.average, back.far_average);
    return back;
}
