// Sixteen slots at once, a lane of each vector a path: for CPUs, whose compilers leave kernels with a float3 scalar (docs/performance.md).
//
// Files whose first lines say «for one path or sixteen» are written by components and without branches. The host includes them a second time for
// sixteen, with types of sixteen and names that end in _lanes (lumiere/device/source.py). A truth is then an int of every lane: −1 or 0.

#define LANES 16u
#define LANE_NUMBERS ((uint16)(0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 10u, 11u, 12u, 13u, 14u, 15u))

typedef struct {
    float16 x, y;
} float2_lanes;

typedef struct {
    float16 x, y, z;
} float3_lanes;

// Lanes that are written or read one by one, too.
typedef union {
    float16 all;
    float lane[16];
} each_float_t;

typedef union {
    int16 all;
    int lane[16];
} each_int_t;

typedef union {
    uint16 all;
    uint lane[16];
} each_uint_t;

// Halves: PyPI's PoCL has no functions of sixteen numbers that it could compile.
static inline float16 sqrt_lanes(float16 x)
{
    return (float16)(sqrt(x.lo), sqrt(x.hi));
}

static inline float16 convert_float_lanes(uint16 x)
{
    return (float16)(convert_float8(x.lo), convert_float8(x.hi));
}

static inline uint16 convert_uint_lanes(float16 x)
{
    return (uint16)(convert_uint8(x.lo), convert_uint8(x.hi));
}

// Before a loop over lanes that fetches from all over: loads one by one are faster than the gathers that compilers would make of them (docs/performance.md).
#define ONE_BY_ONE _Pragma("clang loop vectorize(disable)")

static inline bool any_lane(int16 mask)
{
    const int8 a = mask.lo | mask.hi;
    const int4 b = a.lo | a.hi;
    const int2 c = b.lo | b.hi;
    return (c.x | c.y) != 0;
}

static inline uint count_lanes(int16 mask)
{
    const int8 a = mask.lo + mask.hi;
    const int4 b = a.lo + a.hi;
    const int2 c = b.lo + b.hi;
    return (uint)-(c.x + c.y);
}

static inline float3 lane_of(const float3_lanes *v, uint lane)
{
    const each_float_t x = {v->x}, y = {v->y}, z = {v->z};
    return (float3)(x.lane[lane], y.lane[lane], z.lane[lane]);
}

static inline float3_lanes select_lanes(int16 mask, float3_lanes yes, float3_lanes no)
{
    const float3_lanes v = {mask ? yes.x : no.x, mask ? yes.y : no.y, mask ? yes.z : no.z};
    return v;
}

// Arrays of slots begin at multiples of 64 bytes, and so does each sixteenth of their numbers: vload16 and vstore16, which do not know, take four pieces.
static inline float16 load_float_lanes(global const float *at)
{
    return *(global const float16 *)at;
}

static inline uint16 load_uint_lanes(global const uint *at)
{
    return *(global const uint16 *)at;
}

static inline float3_lanes load3_lanes(global const float *x, global const float *y, global const float *z)
{
    const float3_lanes v = {load_float_lanes(x), load_float_lanes(y), load_float_lanes(z)};
    return v;
}

static inline void store_float_lanes(global float *at, int16 mask, float16 value)
{
    global float16 *all = (global float16 *)at;
    *all = mask ? value : *all;
}

static inline void store_uint_lanes(global uint *at, int16 mask, uint16 value)
{
    global uint16 *all = (global uint16 *)at;
    *all = mask ? value : *all;
}
