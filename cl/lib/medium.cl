// Homogeneous media, what fills a body: extinction σt = 1 / mean free path, the albedo α = σs / σt of one scattering event, the phase function.

#include "lib/circle.cl"
#include "lib/frame.cl"
#include "lib/math.cl"

typedef struct {
    float3 extinction;  // 1 / metre; differs from channel to channel
    float3 albedo;
    float g;            // mean cosine of the scattering angle (Henyey & Greenstein 1941)
} medium_t;

// The medium of which a thick body without a surface reflects `color` of diffuse light: van de Hulst's fit (1980, "Multiple Light Scattering",
// vol. 2, §14) inverted as in Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks", and OpenPBR 1.1, §3.7:
// s = 4.09712 + 4.20863 A − √(9.59217 + 41.6808 A + 17.7126 A²), α = (1 − s²) / (1 − g s²).
static inline medium_t medium_of_color(float3 color, float3 mean_free_path, float g)
{
    medium_t medium;
    const float3 a = clamp(color, 0.0f, 1.0f);
    const float3 s = clamp(4.09712f + 4.20863f * a - sqrt(9.59217f + 41.6808f * a + 17.7126f * a * a), 0.0f, 1.0f);
    medium.g = clamp(g, -0.99f, 0.99f);
    medium.albedo = (1.0f - s * s) / (1.0f - medium.g * s * s);
    medium.extinction = 1.0f / clamp(mean_free_path, 1e-20f, 1e20f);
    return medium;
}

// A medium without a preferred direction, of mean free paths longer by `scale`, in which diffuse light decays over the same distance: the effective
// coefficient √(3 σa (σa + (1 − g) σs)) (Ishimaru 1978, §9.1), with σs smaller and σa larger by `scale`, all but stays.
static inline medium_t medium_similar(medium_t medium, float scale)
{
    const float3 scattering = medium.albedo * medium.extinction * ((1.0f - medium.g) / scale);
    medium.extinction = scattering + (1.0f - medium.albedo) * medium.extinction * scale;
    medium.albedo = scattering / medium.extinction;
    medium.g = 0.0f;
    return medium;
}

// Free flight. One channel is picked and a distance drawn from its exponential; all channels are then weighed by the density with which any of
// them would have drawn it: the balance heuristic with one sample (Veach 1997, §9.2.4; Chiang, Kutz & Burley 2016, "Practical and Controllable
// Subsurface Scattering for Production Path Tracing"). With chances in proportion to the throughput, its sum over the channels never grows.
static inline float3 channel_chances(float3 throughput)
{
    const float3 size = fabs(throughput);
    const float sum = size.x + size.y + size.z;
    return sum > 0.0f ? size / sum : (float3)(1.0f / 3.0f);
}

static inline float flight_distance(const medium_t *medium, float3 chances, float2 u)
{
    const float extinction = u.x < chances.x ? medium->extinction.x : u.x < chances.x + chances.y ? medium->extinction.y : medium->extinction.z;
    return -log(1.0f - u.y) / extinction;
}

static inline float3 over_mean(float3 value, float3 chances)
{
    const float mean = dot(chances, value);
    return mean > 0.0f ? value / mean : (float3)(0.0f);
}

// Weight of a flight that ends in an event after `distance`, with what the event leaves.
static inline float3 event_weight(const medium_t *medium, float3 chances, float distance)
{
    return medium->albedo * over_mean(medium->extinction * exp(-medium->extinction * distance), chances);
}

// Weight of a flight that would have ended beyond `distance`.
static inline float3 passage_weight(const medium_t *medium, float3 chances, float distance)
{
    return over_mean(exp(-medium->extinction * distance), chances);
}

// What absorption alone leaves of light that goes straight on.
static inline float3 unscattered(const medium_t *medium, float distance)
{
    const float3 absorption = (1.0f - medium->albedo) * medium->extinction;
    return (float3)(absorption.x > 0.0f ? exp(-absorption.x * distance) : 1.0f, absorption.y > 0.0f ? exp(-absorption.y * distance) : 1.0f,
                    absorption.z > 0.0f ? exp(-absorption.z * distance) : 1.0f);
}

// A direction from Henyey & Greenstein's phase function about the direction of flight (PBR 4ed, eq. 11.14, here multiplied out: nothing cancels
// where g is near 0).
static inline float3 phase_sample(float g, float3 direction, float2 u)
{
    const float s = 2.0f * u.x - 1.0f, below = 1.0f + g * s;
    const float cosine = clamp((s + g * (0.5f * (s * s + 3.0f) + g * (s - 0.5f * g * (1.0f - s * s)))) / (below * below), -1.0f, 1.0f);
    const float sine = sqrt((1.0f - cosine) * (1.0f + cosine));
    const frame_t frame = frame_about(direction);
    return normalize(frame_to_world(&frame, (float3)(sine * circle_point(u.y), cosine)));
}
