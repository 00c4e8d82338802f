// Where a sampler stands, and two numbers of it for which it has one dimension.

#include "lib/lanes.cl"

typedef struct {
    LANES seed;   // of the pixel
    LANES index;  // of the sample
#ifdef SAMPLER_STRATA
    uint strata_x;
    uint strata_y;
#endif
} sequence_t;

typedef struct {
    LANES x;
    LANES y;
} pair_t;
