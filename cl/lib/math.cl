// Constants and small functions that everything uses.

#include "lib/vector.cl"

#define PI 3.14159265358979323846f
#define INV_PI 0.31830988618379067154f
#define INV_TWO_PI 0.15915494309189533577f
#define MACHINE_EPSILON 5.9604644775390625e-8f  // half the distance from 1 to the next float

// Bound of the relative error after n roundings (Higham 2002, §3.1; PBR 4ed, eq. 6.18).
#define GAMMA(n) (((n) * MACHINE_EPSILON) / (1.0f - (n) * MACHINE_EPSILON))

static inline float max_component(float3 v)
{
    return fmax(v.x, fmax(v.y, v.z));
}

static inline float luminance(float3 c)
{
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

static inline float3 load3(global const float *p)
{
    return (float3)(p[0], p[1], p[2]);
}

// Rows of a 3 × 3 matrix times v.
static inline float3 rotate3(global const float *m, float3 v)
{
    return (float3)(dot(load3(m), v), dot(load3(m + 3), v), dot(load3(m + 6), v));
}

// The transpose of a 3 × 3 matrix times v.
static inline float3 rotate3_back(global const float *m, float3 v)
{
    return v.x * load3(m) + v.y * load3(m + 3) + v.z * load3(m + 6);
}
