// What sampling a BSDF returns. The contract in words: docs/architecture.md. For one path or sixteen (lib/lanes.cl).

#include "lib/math.cl"

typedef struct {
    float3 wi;      // sampled direction in the local shading frame, unit
    float3 weight;  // f |cos θi| / pdf; 0 where the sample failed
    float pdf;      // over solid angle; for a specular lobe, the probability of having picked it
    float eta;      // relative index of refraction crossed (transmitted over incident side), 1 for a reflection
    int specular;   // the direction came from a Dirac lobe
#ifdef WALKS
    int walks;      // wi leads into the body, or stays in it: a random walk in its medium follows
#endif
} bsdf_sample_t;

static inline bsdf_sample_t bsdf_sample_failed(void)
{
    bsdf_sample_t s;
    s.wi = float3_of(0.0f, 0.0f, 1.0f);
    s.weight = float3_of(0.0f, 0.0f, 0.0f);
    s.pdf = 0.0f;
    s.eta = 1.0f;
    s.specular = 0;
#ifdef WALKS
    s.walks = 0;
#endif
    return s;
}
