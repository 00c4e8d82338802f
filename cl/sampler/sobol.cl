// Owen-scrambled Sobol points in two dimensions: each pair of dimensions is the Sobol (0, 2)-sequence with a scrambling and an order of its own
// (Burley 2020, "Practical Hash-based Owen Scrambling", §5). Any 2^k first samples are stratified in each pair.
//
// The orders of pairs that one contribution depends on go together, so that it is stratified over all of their dimensions: the way by which a path leaves
// a vertex (the camera's: the point of the film) and the next one, and the light that is drawn where either has led. The others' know nothing of each other.
//
// For one path or sixteen (lib/lanes.cl).

#include "lib/dimensions.cl"
#include "lib/hash.cl"

static inline uint reverse_bits(uint x)
{
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

// Owen scrambling of a number whose bits are reversed: each bit is flipped by a hash of the bits below it
// (Laine & Karras 2011, §3; constants of Vegdahl 2021, "Owen Scrambling Based on Better Hashing").
static inline uint scramble_reversed(uint x, uint seed)
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
static inline uint sobol_second_reversed(uint x)
{
    x ^= (x & 0xaaaaaaaau) >> 1;
    x ^= (x & 0xccccccccu) >> 2;
    x ^= (x & 0xf0f0f0f0u) >> 4;
    x ^= (x & 0xff00ff00u) >> 8;
    x ^= (x & 0xffff0000u) >> 16;
    return x;
}

// The order in which a dimension visits its points: a scrambling of the index that keeps blocks of 2^k together.
static inline uint shuffled_index(uint index, uint seed)
{
    return reverse_bits(scramble_reversed(reverse_bits(index), seed));
}

// A digit of x in base 4 chooses a quarter of the square. To those that `mask` holds, a linear function of the digit `shift` bits above is added: of 1 it
// is `one`, of 2 `two`, and of 3 their sum, all sums being without carry.
static inline uint add_digits(uint x, uint mask, uint shift, uint one, uint two)
{
    const uint above = x >> shift, low = above & mask & 0x55555555u, high = (above >> 1) & mask & 0x55555555u;
    return x ^ (low * one) ^ (high * two);
}

// Orders that go with that of `index`: its digits times an upper triangular matrix, a product over distances of 1, 2, 4 and 8 digits as Pascal's triangle is.
// With the functions of Faure's sequences (1982) two orders go together, but of three two would not. These are what a search has found: any two of the
// three are a (t, k, 4)-net in the first 2^k points, with t at most 2 for 16 and 64 points and 4 for 256 (tests/sampler).
static inline uint second_order(uint index)
{
    index = add_digits(index, 0x33333333u, 2u, 0u, 1u);
    index = add_digits(index, 0x0f0f0f0fu, 4u, 2u, 3u);
    index = add_digits(index, 0x00ff00ffu, 8u, 3u, 0u);
    return add_digits(index, 0x0000ffffu, 16u, 2u, 3u);
}

static inline uint third_order(uint index)
{
    index = add_digits(index, 0x33333333u, 2u, 1u, 3u);
    index = add_digits(index, 0x0f0f0f0fu, 4u, 2u, 2u);
    index = add_digits(index, 0x00ff00ffu, 8u, 1u, 0u);
    return add_digits(index, 0x0000ffffu, 16u, 3u, 1u);
}

static inline uint sample_1d(const sequence_t *sampler, uint dimension)
{
    const uint seed = hash_combine(sampler->seed, dimension);
    const uint index = shuffled_index(sampler->index, seed);
    return reverse_bits(scramble_reversed(index, hash_uint(seed ^ 0x5bd1e995u)));
}

static inline pair_t sample_2d(const sequence_t *sampler, uint dimension)
{
    const uint seed = hash_combine(sampler->seed, dimension), which = dimension % DIMENSIONS_A_VERTEX;
    // Two vertices share an order: that of the first's direction.
    const uint vertex = dimension / DIMENSIONS_A_VERTEX - (which == DIMENSION_LIGHT ? 1u : 0u);
    const uint first = (vertex - vertex % 2u) * DIMENSIONS_A_VERTEX + DIMENSION_BSDF;
    const uint shared = which == DIMENSION_LIGHT ? first : which == DIMENSION_BSDF ? first : dimension;
    uint index = shuffled_index(sampler->index, hash_combine(sampler->seed, shared));
    index = which == DIMENSION_LIGHT ? third_order(index) : which == DIMENSION_BSDF ? (vertex % 2u == 0u ? index : second_order(index)) : index;
    const pair_t pair = {reverse_bits(scramble_reversed(index, hash_uint(seed ^ 0x5bd1e995u))),
                         reverse_bits(scramble_reversed(sobol_second_reversed(index), hash_uint(seed ^ 0x27d4eb2fu)))};
    return pair;
}
