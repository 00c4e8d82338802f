// Independent random numbers: a hash of (seed, pixel, index, dimension).

#include "lib/hash.cl"

static inline uint sample_1d(const sequence_t *sampler, uint dimension)
{
    return hash_combine(hash_combine(sampler->seed, sampler->index), dimension);
}

static inline uint2 sample_2d(const sequence_t *sampler, uint dimension)
{
    uint x = sample_1d(sampler, dimension);
    return (uint2)(x, hash_uint(x ^ 0x68bc21ebu));
}
