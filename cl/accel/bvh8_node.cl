// A ray against the eight boxes of a node, conservatively.

#include "accel/slab.cl"
#include "lib/ray.cl"

#define BVH8_LEAF 0x80000000u
#define BVH8_BLOCK 80u  // words a block
#define BVH8_STACK 352  // seven more a level, over the 48 levels that a topology has at most, and a node's eight

// What compilers for CPUs may have. A mask's bits by one instruction: where a target has AVX-512, its compiler finds a way as short by itself.
#if defined(CPU) && defined(__has_builtin)
#if __has_builtin(__builtin_prefetch)
#define BVH8_FETCH_LINE(words, line) __builtin_prefetch((const void *)(size_t)((words) + 16 * (line)), 0, 3)
#endif
#if __has_builtin(__builtin_ctzl)
#define BVH8_COUNT_TRAILING_ZEROS
#if defined(__AVX__) && !defined(__AVX512F__) && __has_builtin(__builtin_ia32_movmskps256)
#define BVH8_MOVE_MASK
#endif
#endif
#endif
#ifndef BVH8_FETCH_LINE
#define BVH8_FETCH_LINE(words, line)
#endif

// The five lines of a block, or the four of a node and one for nothing, into the caches of a CPU; where the compiler has no such thing, nothing.
static inline void bvh8_fetch(global const float *words)
{
    BVH8_FETCH_LINE(words, 0);
    BVH8_FETCH_LINE(words, 1);
    BVH8_FETCH_LINE(words, 2);
    BVH8_FETCH_LINE(words, 3);
    BVH8_FETCH_LINE(words, 4);
}

typedef struct {
    float3 o;
    float3 inverse_d;
    float3 inverse_far;  // the same, with the margin that makes the test conservative (accel/slab.cl)
    uint3 near;  // which of a node's vectors holds each axis's near planes; the far ones are its neighbour
} bvh8_ray_t;

static inline bvh8_ray_t bvh8_prepare(const ray_t *ray)
{
    bvh8_ray_t prepared;
    prepared.o = ray->o;
    prepared.inverse_d = 1.0f / ray->d;
    prepared.inverse_far = prepared.inverse_d * SLAB_MARGIN;
    prepared.near.x = prepared.inverse_d.x < 0.0f ? 1u : 0u;
    prepared.near.y = prepared.inverse_d.y < 0.0f ? 3u : 2u;
    prepared.near.z = prepared.inverse_d.z < 0.0f ? 5u : 4u;
    return prepared;
}

typedef union {
    float8 all;
    float lane[8];
} bvh8_floats_t;

// Of a block's triangles: (count − 1) << 28 | the first.
static inline uint bvh8_range(global const float *block)
{
    return ((global const uint *)block)[72];
}

// The lanes that are set: bit i, or bit 0 of byte i.
static inline ulong bvh8_lanes(int8 mask)
{
#ifdef BVH8_MOVE_MASK
    union {
        int8 all;
        float words __attribute__((vector_size(32)));
    } lanes = {mask};
    return (ulong)(uint)__builtin_ia32_movmskps256(lanes.words);
#else
    return as_ulong(convert_char8(mask)) & 0x0101010101010101UL;
#endif
}

// The next step waits for it. clz would be a call on some runtimes, across which no vector stays in a register.
static inline uint bvh8_first_lane(ulong lanes)
{
#if defined(BVH8_MOVE_MASK)
    return (uint)__builtin_ctzl(lanes);
#elif defined(BVH8_COUNT_TRAILING_ZEROS)
    return (uint)__builtin_ctzl(lanes) >> 3;
#else
    // Lane k times the constant has its byte 7 − k on top: k.
    return (uint)((lanes & (0UL - lanes)) * 0x0001020304050607UL >> 56);
#endif
}

// Which boxes the ray meets within t_max, and where it enters them. The comparisons drop the NaN of 0 × infinity.
static inline ulong bvh8_enter(const bvh8_ray_t *ray, global const float *node, float t_max, bvh8_floats_t *enter)
{
    global const float8 *planes = (global const float8 *)node;
    float8 near = (planes[ray->near.x] - ray->o.x) * ray->inverse_d.x, far = (planes[ray->near.x ^ 1u] - ray->o.x) * ray->inverse_far.x;
    float8 near_y = (planes[ray->near.y] - ray->o.y) * ray->inverse_d.y, far_y = (planes[ray->near.y ^ 1u] - ray->o.y) * ray->inverse_far.y;
    float8 near_z = (planes[ray->near.z] - ray->o.z) * ray->inverse_d.z, far_z = (planes[ray->near.z ^ 1u] - ray->o.z) * ray->inverse_far.z;
    near = near > 0.0f ? near : (float8)(0.0f);
    near = near_y > near ? near_y : near;
    near = near_z > near ? near_z : near;
    const float last = t_max * SLAB_MARGIN;
    far = far < last ? far : (float8)(last);
    far = far_y < far ? far_y : far;
    far = far_z < far ? far_z : far;
    enter->all = near;
    return bvh8_lanes(near <= far);
}
