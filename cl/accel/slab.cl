// Rays against boxes, conservatively.

#include "lib/ray.cl"

typedef struct {
    float3 o;
    float3 inverse_d;
} slab_ray_t;

static inline slab_ray_t slab_prepare(const ray_t *ray)
{
    slab_ray_t prepared;
    prepared.o = ray->o;
    prepared.inverse_d = 1.0f / ray->d;
    return prepared;
}

// A slab's distance has a relative error of at most gamma(7): the subtraction and the product each round once, and OpenCL allows
// the reciprocal 2.5 ulp (OpenCL 1.2, table 7.1). Twice that, on the far side alone, makes the test conservative (Ize 2013, "Robust
// BVH ray traversal"): 1 + 2 gamma(7) < 1 + 2^-20.
#define SLAB_MARGIN (1.0f + 0x1p-20f)

// Where the ray enters the box, at least 0, or infinity where it misses it within t_max. The comparisons drop the NaN of
// 0 × infinity: a ray within the plane of a face counts as inside that slab.
static inline float slab_enter(const slab_ray_t *ray, float2 x, float2 y, float2 z, float t_max)
{
    float2 tx = (x - ray->o.x) * ray->inverse_d.x;
    float2 ty = (y - ray->o.y) * ray->inverse_d.y;
    float2 tz = (z - ray->o.z) * ray->inverse_d.z;
    // By the sign of the inverse, which tells 0 from -0.
    tx = ray->inverse_d.x < 0.0f ? tx.yx : tx;
    ty = ray->inverse_d.y < 0.0f ? ty.yx : ty;
    tz = ray->inverse_d.z < 0.0f ? tz.yx : tz;
    float near = 0.0f, far = t_max;
    near = tx.x > near ? tx.x : near;
    near = ty.x > near ? ty.x : near;
    near = tz.x > near ? tz.x : near;
    far = tx.y < far ? tx.y : far;
    far = ty.y < far ? ty.y : far;
    far = tz.y < far ? tz.y : far;
    return near <= far * SLAB_MARGIN ? near : INFINITY;
}
