// The random numbers of a path's vertex, drawn where they are wanted.

#include "lib/path.cl"
#include "lib/sampler.cl"

typedef struct {
    sequence_t sampler;
    uint depth;
} vertex_random_t;

static inline pair_t random_light(const vertex_random_t *random)
{
    return sample_2d(&random->sampler, vertex_dimension(random->depth, DIMENSION_LIGHT));
}

static inline uint random_lobe(const vertex_random_t *random)
{
    return sample_1d(&random->sampler, vertex_dimension(random->depth, DIMENSION_LOBE));
}

static inline pair_t random_bsdf(const vertex_random_t *random)
{
    return sample_2d(&random->sampler, vertex_dimension(random->depth, DIMENSION_BSDF));
}

static inline uint random_roulette(const vertex_random_t *random)
{
    return sample_1d(&random->sampler, vertex_dimension(random->depth, DIMENSION_ROULETTE));
}
