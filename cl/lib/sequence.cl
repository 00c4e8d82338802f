// Where a sampler stands, and two numbers of it for which it has one dimension. For one path or sixteen (lib/lanes.cl).

typedef struct {
    uint seed;   // of the pixel
    uint index;  // of the sample
#ifdef SAMPLER_STRATA
    uint strata_x;
    uint strata_y;
#endif
} sequence_t;

typedef struct {
    uint x;
    uint y;
} pair_t;
