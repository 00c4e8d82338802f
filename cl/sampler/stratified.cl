// Jittered strata, visited in a random order that differs from dimension to dimension (Kensler 2013, "Correlated Multi-Jittered Sampling", §3).
// sampler->strata_x × sampler->strata_y ≥ the samples of a pixel; beyond them the strata are visited again with other jitter.

#include "lib/hash.cl"

// Element `i` of a random permutation of 0 … length − 1 (Kensler 2013, listing 3: cycle walking over a hash of the next power of two; the last
// sum, which overflows there, is kept below 2 length).
static inline uint permute(uint i, uint length, uint seed)
{
    uint mask = length - 1u;
    mask |= mask >> 1;
    mask |= mask >> 2;
    mask |= mask >> 4;
    mask |= mask >> 8;
    mask |= mask >> 16;
    do {
        i ^= seed;
        i *= 0xe170893du;
        i ^= seed >> 16;
        i ^= (i & mask) >> 4;
        i ^= seed >> 8;
        i *= 0x0929eb3fu;
        i ^= seed >> 23;
        i ^= (i & mask) >> 1;
        i *= 1u | seed >> 27;
        i *= 0x6935fa69u;
        i ^= (i & mask) >> 11;
        i *= 0x74dcb303u;
        i ^= (i & mask) >> 2;
        i *= 0x9e501cc3u;
        i ^= (i & mask) >> 2;
        i *= 0xc860a3dfu;
        i &= mask;
        i ^= i >> 5;
    } while (i >= length);
    return (i + seed % length) % length;
}

// Stratum of `count`, jittered, as 32 bits of the unit interval.
static inline uint jittered(uint stratum, uint count, uint jitter)
{
    ulong width = 0x100000000UL / count;
    return (uint)(stratum * width + ((width * jitter) >> 32));
}

static inline uint sample_1d(const sequence_t *sampler, uint dimension)
{
    uint count = sampler->strata_x * sampler->strata_y;
    uint round = sampler->index / count;
    uint seed = hash_combine(hash_combine(sampler->seed, dimension), round);
    uint stratum = permute(sampler->index % count, count, seed);
    return jittered(stratum, count, hash_combine(seed, sampler->index));
}

static inline pair_t sample_2d(const sequence_t *sampler, uint dimension)
{
    uint count = sampler->strata_x * sampler->strata_y;
    uint round = sampler->index / count;
    uint seed = hash_combine(hash_combine(sampler->seed, dimension), round);
    uint stratum = permute(sampler->index % count, count, seed);
    uint jitter = hash_combine(seed, sampler->index);
    const pair_t pair = {jittered(stratum % sampler->strata_x, sampler->strata_x, jitter),
                         jittered(stratum / sampler->strata_x, sampler->strata_y, hash_uint(jitter ^ 0x68bc21ebu))};
    return pair;
}
