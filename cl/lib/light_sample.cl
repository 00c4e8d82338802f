// What sampling a light returns. For one path or sixteen (lib/lanes.cl).

typedef struct {
    float3 target;    // point to connect to, or direction where `infinite`
    float3 radiance;  // towards the reference point; for a delta light, its irradiance on a facing surface
    float pdf;        // over solid angle at the reference; 1 for a delta light; 0: the sample failed
    int infinite;
    int delta;        // no ray meets the light by chance
} light_sample_t;

static inline light_sample_t light_sample_new(float3 target, float3 radiance, float pdf, int infinite, int delta)
{
    light_sample_t s;
    s.target = target;
    s.radiance = radiance;
    s.pdf = pdf;
    s.infinite = infinite;
    s.delta = delta;
    return s;
}
