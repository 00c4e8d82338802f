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

static inline discrete_t discrete_sample(global const uint *cdf, uint count, uint u)
{
    uint low = 0u, high = count - 1u;
    while (low < high) {
        uint middle = (low + high) >> 1;
        if (cdf[middle] < u)
            low = middle + 1u;
        else
            high = middle;
    }
    discrete_t d;
    d.index = low;
    d.probability = discrete_probability(cdf, low);
    uint below = discrete_below(cdf, low);
    // (u − below) 2³² / width: a quotient of floats, and what that leaves. Dividing 64-bit integers is slow.
    ulong width = (ulong)(cdf[low] - below) + 1UL;
    float reciprocal = 1.0f / (float)width;
    uint first = (uint)fmin((float)(u - below) * reciprocal * 0x1p32f, 0x1.fffffep31f);
    long left = (long)(((ulong)(u - below) << 32) - (ulong)first * width);
    d.rest = (uint)clamp((long)first + (long)((float)left * reciprocal), 0L, 0xffffffffL);
    return d;
}
