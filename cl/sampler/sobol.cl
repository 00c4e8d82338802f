// Owen-scrambled Sobol points in two dimensions, padded: each pair of dimensions is the Sobol (0, 2)-sequence with an order and a scrambling
// of its own (Burley 2020, "Practical Hash-based Owen Scrambling", §5). Any 2^k first samples are stratified in each pair.

#include "lib/hash.cl"

static inline LANES reverse_bits(LANES x)
{
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

// Owen scrambling of a number whose bits are reversed: each bit is flipped by a hash of the bits below it
// (Laine & Karras 2011, §3; constants of Vegdahl 2021, "Owen Scrambling Based on Better Hashing").
static inline LANES scramble_reversed(LANES x, LANES seed)
{
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Second Sobol dimension of `index`, bits reversed. Its generator matrix is Pascal's triangle modulo 2, the fivefold Kronecker power of (1 1; 0 1):
// so the product is five masked shifts (the matrix: Sobol 1967; Ahmed 2024, "An Implementation Algorithm of 2D Sobol Sequence").
static inline LANES sobol_second_reversed(LANES x)
{
    x ^= (x & 0xaaaaaaaau) >> 1;
    x ^= (x & 0xccccccccu) >> 2;
    x ^= (x & 0xf0f0f0f0u) >> 4;
    x ^= (x & 0xff00ff00u) >> 8;
    x ^= (x & 0xffff0000u) >> 16;
    return x;
}

// The order in which a dimension visits its points: a scrambling of the index that keeps blocks of 2^k together.
static inline LANES shuffled_index(LANES index, LANES seed)
{
    return reverse_bits(scramble_reversed(reverse_bits(index), seed));
}

static inline LANES sample_1d(const sequence_t *sampler, LANES dimension)
{
    const LANES seed = hash_combine(sampler->seed, dimension);
    const LANES index = shuffled_index(sampler->index, seed);
    return reverse_bits(scramble_reversed(index, hash_uint(seed ^ 0x5bd1e995u)));
}

static inline pair_t sample_2d(const sequence_t *sampler, LANES dimension)
{
    const LANES seed = hash_combine(sampler->seed, dimension);
    const LANES index = shuffled_index(sampler->index, seed);
    const pair_t pair = {reverse_bits(scramble_reversed(index, hash_uint(seed ^ 0x5bd1e995u))),
                         reverse_bits(scramble_reversed(sobol_second_reversed(index), hash_uint(seed ^ 0x27d4eb2fu)))};
    return pair;
}
