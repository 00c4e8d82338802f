// Integer CDFs (lumiere/light/distribution.py): entry i is drawn by a uniform 32-bit u with cdf[i − 1] < u ≤ cdf[i], the first from 0 on.
// An entry of weight 0 behind the first has no u.

typedef struct {
    uint index;
    float probability;
    uint rest;  // what is left of u, stretched to 32 bits
} discrete_t;

static inline uint discrete_below(global const uint *cdf, uint index)
{
    return index == 0u ? 0u : cdf[index - 1u] + 1u;
}

static inline float discrete_probability(global const uint *cdf, uint index)
{
    // The width of an only entry is 2³², one more than an uint holds.
    float width = index == 0u ? (float)cdf[0] + 1.0f : (float)(cdf[index] - cdf[index - 1u]);
    return width * 0x1p-32f;
}

// The entry that u draws, by halving without a branch that u decides.
static inline uint discrete_find(global const uint *cdf, uint count, uint u)
{
    uint low = 0u;
    for (uint left = count; left > 1u; left -= left / 2u)
        low += cdf[low + left / 2u - 1u] < u ? left / 2u : 0u;
    return low;
}

// What u leaves once it has drawn the entry `index`: (u − below) 2³² / width, a quotient of floats, and what that leaves. Dividing 64-bit integers is slow,
// and fmin and clamp are calls on PyPI's PoCL.
static inline uint discrete_rest(global const uint *cdf, uint index, uint u)
{
    uint below = discrete_below(cdf, index);
    ulong width = (ulong)(cdf[index] - below) + 1UL;
    float reciprocal = 1.0f / (float)width;
    float quotient = (float)(u - below) * reciprocal * 0x1p32f;
    uint first = (uint)(quotient < 0x1.fffffep31f ? quotient : 0x1.fffffep31f);
    long left = (long)(((ulong)(u - below) << 32) - (ulong)first * width);
    long rest = (long)first + (long)((float)left * reciprocal);
    return (uint)(rest < 0L ? 0L : rest > 0xffffffffL ? 0xffffffffL : rest);
}

static inline discrete_t discrete_sample(global const uint *cdf, uint count, uint u)
{
    discrete_t d;
    d.index = discrete_find(cdf, count, u);
    d.probability = discrete_probability(cdf, d.index);
    d.rest = discrete_rest(cdf, d.index, u);
    return d;
}
