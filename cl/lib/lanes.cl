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

// What a register holds, for what is short of registers (accel/flat16.cl): sixteen numbers, also where the compiler doesn't know yet, or eight.
#if defined(__AVX512F__) || defined(__SPIR__) || defined(__SPIRV__)
#define PARTS 1u
typedef float16 float_part;
typedef int16 int_part;
typedef uint16 uint_part;
#define as_float_part as_float16
#define as_int_part as_int16
#define as_uint_part as_uint16
#define any_in_part any_lane
#else
#define PARTS 2u
typedef float8 float_part;
typedef int8 int_part;
typedef uint8 uint_part;
#define as_float_part as_float8
#define as_int_part as_int8
#define as_uint_part as_uint8
#define any_in_part any_of_eight
#endif
#define LANES_A_PART (LANES / PARTS)

// Lanes that are written or read one by one, by parts, or by fours, too.
typedef union {
    float16 all;
    float_part part[PARTS];
    float4 four[4];
    float lane[16];
} each_float_t;

typedef union {
    int16 all;
    int_part part[PARTS];
    int lane[16];
} each_int_t;

typedef union {
    uint16 all;
    uint_part part[PARTS];
    uint lane[16];
} each_uint_t;

#if defined(__has_builtin) && !defined(__SPIR__) && !defined(__SPIRV__)
#if __has_builtin(__builtin_sqrtf)
#define BUILTIN_SQRT
#endif
#endif

// Compilers make one instruction of the loop. The square root of eight numbers is a call on PyPI's PoCL.
static inline float8 sqrt_of_eight(float8 x)
{
#ifdef BUILTIN_SQRT
    union {
        float8 all;
        float each[8];
    } root = {x};
    for (uint i = 0u; i < 8u; i++)
        root.each[i] = __builtin_sqrtf(root.each[i]);
    return root.all;
#else
    return sqrt(x);
#endif
}

// Halves: PyPI's PoCL has no functions of sixteen numbers that it could compile.
static inline float16 sqrt_lanes(float16 x)
{
    return (float16)(sqrt_of_eight(x.lo), sqrt_of_eight(x.hi));
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

static inline bool any_of_eight(int8 mask)
{
    const int4 a = mask.lo | mask.hi;
    const int2 b = a.lo | a.hi;
    return (b.x | b.y) != 0;
}

static inline bool any_lane(int16 mask)
{
    return any_of_eight(mask.lo | mask.hi);
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
