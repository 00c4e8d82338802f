// Independent random numbers: a hash of (seed, pixel, index, dimension). For one path or sixteen (lib/lanes.cl).

#include "lib/hash.cl"

static inline uint sample_1d(const sequence_t *sampler, uint dimension)
{
    return hash_combine(hash_combine(sampler->seed, sampler->index), dimension);
}

static inline pair_t sample_2d(const sequence_t *sampler, uint dimension)
{
    const uint x = sample_1d(sampler, dimension);
    const pair_t pair = {x, hash_uint(x ^ 0x68bc21ebu)};
    return pair;
}
