// A primitive while a tree is built: its box as the minima low x, y, z and -high x, y, z (lanes 0-2 and 4-6), so that one minimum joins two boxes; in
// lane 3 its number, made a float that is no denormal.

#define PRIMITIVE_NUMBER 0x10000000u

static inline float8 primitive(float3 low, float3 high, uint number)
{
    return (float8)(low, as_float(number + PRIMITIVE_NUMBER), -high, 0.0f);
}

static inline uint primitive_number(float8 box)
{
    return as_uint(box.s3) - PRIMITIVE_NUMBER;
}

static inline float8 box_join(float8 a, float8 b)
{
    return a < b ? a : b;
}

static inline float8 box_nothing(void)
{
    return (float8)(INFINITY);
}

// Half the centroid as a box of that point alone: half of it, so that no extent overflows.
static inline float8 box_centre(float8 box)
{
    return 0.25f * box - 0.25f * box.s45670123;
}

// Half the extents; no difference of floats overflows so.
static inline float3 box_half_extents(float8 box)
{
    return -0.5f * box.s456 - 0.5f * box.s012;
}

// A power of two that brings the largest of the extents near 1, so that no product of two overflows.
static inline float box_unit_scale(float8 box)
{
    float3 h = box_half_extents(box);
    float largest = h.x > h.y ? h.x : h.y;
    largest = h.z > largest ? h.z : largest;
    uint exponent = as_uint(largest) >> 23;
    return as_float((exponent < 1u ? 253u : exponent > 252u ? 1u : 253u - exponent) << 23);
}

// An eighth of the surface area of a scaled box.
static inline float box_area(float8 box, float scale)
{
    float3 h = box_half_extents(box) * scale;
    return h.x * (h.y + h.z) + h.y * h.z;
}

// Floats as integers of the same order, whose minima are found by atomics.
static inline uint float_key(float x)
{
    uint bits = as_uint(x);
    return bits >> 31 ? ~bits : bits | 0x80000000u;
}

static inline float key_float(uint key)
{
    return as_float(key >> 31 ? key & 0x7fffffffu : ~key);
}

// Six keys of a box.
static inline void box_join_keys(global uint *keys, float8 box)
{
    atomic_min(keys, float_key(box.s0));
    atomic_min(keys + 1, float_key(box.s1));
    atomic_min(keys + 2, float_key(box.s2));
    atomic_min(keys + 3, float_key(box.s4));
    atomic_min(keys + 4, float_key(box.s5));
    atomic_min(keys + 5, float_key(box.s6));
}

static inline float8 box_of_keys(global const uint *keys)
{
    return (float8)(key_float(keys[0]), key_float(keys[1]), key_float(keys[2]), 0.0f, key_float(keys[3]), key_float(keys[4]), key_float(keys[5]), 0.0f);
}
