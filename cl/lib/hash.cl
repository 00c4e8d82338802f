// Integer hashes. For one path or sixteen (lib/lanes.cl).

// A permutation of 32 bits whose every input bit reaches every output bit (Wellons 2018, "prospector", lowbias32).
static inline uint hash_uint(uint x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

static inline uint hash_combine(uint seed, uint value)
{
    return hash_uint(seed ^ (value * 0x9e3779b9u + 0x85ebca6bu));
}
