// Integer hashes.

#include "lib/lanes.cl"

// A permutation of 32 bits whose every input bit reaches every output bit (Wellons 2018, "prospector", lowbias32).
static inline LANES hash_uint(LANES x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

static inline LANES hash_combine(LANES seed, LANES value)
{
    return hash_uint(seed ^ (value * 0x9e3779b9u + 0x85ebca6bu));
}
