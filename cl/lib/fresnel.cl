// Fresnel's equations for unpolarised light: how much of it a smooth interface reflects, and Snell's law: where the rest goes.
// Exact, no Schlick. Written so that nothing cancels where the index is near 1 or the angle grazes, in single precision.

// Reflectance between dielectrics. cos_i ≥ 0: cosine of incidence; eta: index of the far side over the near side's.
// *cos_t: cosine of refraction, 0 where reflection is total.
static inline float fresnel_dielectric(float cos_i, float eta, float *cos_t)
{
    if (eta == 1.0f) {  // no interface; the equations below are 0 / 0 at grazing incidence
        *cos_t = cos_i;
        return 0.0f;
    }
    // Snell: η² cos²θt = η² − sin²θi, the difference written as (η² − 1) + cos²θi.
    const float q = (eta - 1.0f) * (eta + 1.0f) + cos_i * cos_i;
    if (q <= 0.0f) {
        *cos_t = 0.0f;
        return 1.0f;
    }
    const float n_cos_t = sqrt(q);
    *cos_t = n_cos_t / eta;
    // Perpendicular and parallel polarisation (Born & Wolf 1999, §1.5.2).
    const float s = (cos_i - n_cos_t) / (cos_i + n_cos_t);
    const float p = (eta * cos_i - *cos_t) / (eta * cos_i + *cos_t);
    return 0.5f * (s * s + p * p);
}

// One channel of fresnel_conductor. With (a + ib)² = (η + ik)² − sin²θ (Born & Wolf 1999, §14.2):
//     Rs = ((a − cosθ)² + b²) / ((a + cosθ)² + b²)
//     Rp = Rs ((a − sinθ tanθ)² + b²) / ((a + sinθ tanθ)² + b²)
// Sums of squares, so that rounding can neither make them negative nor exceed 1.
static inline float fresnel_conductor_channel(float cos_i, float eta, float k)
{
    const float sin2 = fmax(0.0f, 1.0f - cos_i * cos_i);
    const float difference = (eta - k) * (eta + k) - sin2;  // a² − b²
    const float product = eta * k;                          // ab
    const float sum = sqrt(difference * difference + 4.0f * product * product);  // a² + b²
    // The larger of a² and b² directly, the other by the product: neither cancels, and η = 0 gives a = 0, total reflection, exactly.
    const float larger = 0.5f * (sum + fabs(difference));
    const float smaller = larger > 0.0f ? product * product / larger : 0.0f;
    const float a = sqrt(difference > 0.0f ? larger : smaller);
    const float b2 = difference > 0.0f ? smaller : larger;

    const float s_minus = a - cos_i, s_plus = a + cos_i;
    const float s_below = s_plus * s_plus + b2;
    const float rs = s_below > 0.0f ? (s_minus * s_minus + b2) / s_below : 1.0f;
    // Above and below multiplied by cos²θ, for tanθ.
    const float p_minus = a * cos_i - sin2, p_plus = a * cos_i + sin2, b2_cos2 = b2 * cos_i * cos_i;
    const float p_below = p_plus * p_plus + b2_cos2;
    const float ratio = p_below > 0.0f ? (p_minus * p_minus + b2_cos2) / p_below : 1.0f;
    return 0.5f * rs * (1.0f + ratio);
}

// Reflectance of a conductor of complex index eta + i k, relative to the near side's, per channel. cos_i ≥ 0.
static inline float3 fresnel_conductor(float cos_i, float3 eta, float3 k)
{
    return (float3)(fresnel_conductor_channel(cos_i, eta.x, k.x), fresnel_conductor_channel(cos_i, eta.y, k.y),
                    fresnel_conductor_channel(cos_i, eta.z, k.z));
}

// w mirrored about the normal m. Both unit.
static inline float3 reflect_about(float3 w, float3 m)
{
    return 2.0f * dot(w, m) * m - w;
}

// w refracted through the interface of unit normal m on w's side: Walter et al. 2007, eq. 40, with cos_t from fresnel_dielectric.
static inline float3 refract_through(float3 w, float3 m, float cos_i, float cos_t, float eta)
{
    return normalize((cos_i / eta - cos_t) * m - w / eta);
}
