// A ray against the eight quantised boxes of a node of 80 bytes, conservatively. lumiere/accel/cwbvh.py says what is in its five uint4.

#include "accel/slab.cl"
#include "lib/ray.cl"

#define CWBVH_FIRST_INNER 0x01000000u  // the lowest of the bits that stand for nodes, in what a node's test gives

typedef struct {
    float3 o;
    float3 inverse_d;
    uint octant;  // bits 2, 1, 0: the ray goes up along x, y, z, and so meets slots without that bit first
} cwbvh_ray_t;

static inline cwbvh_ray_t cwbvh_prepare(const ray_t *ray)
{
    cwbvh_ray_t prepared;
    prepared.o = ray->o;
    prepared.inverse_d = 1.0f / ray->d;
    prepared.octant = (prepared.inverse_d.x < 0.0f ? 0u : 4u) | (prepared.inverse_d.y < 0.0f ? 0u : 2u) | (prepared.inverse_d.z < 0.0f ? 0u : 1u);
    return prepared;
}

// A node's grid as a ray sees it: a step along each axis, and the corner from the ray's origin. The roundings of that difference and of what is
// done to it here are less than 2^-22 of it, and are taken from the near planes and given to the far ones; the sum with the steps, which are exact,
// rounds once, as the difference in slab_enter does. So SLAB_MARGIN does the rest.
typedef struct {
    float3 step;
    float3 near;
    float3 far;
} cwbvh_grid_t;

static inline cwbvh_grid_t cwbvh_grid(const cwbvh_ray_t *ray, uint4 head)
{
    cwbvh_grid_t grid;
    grid.step = (float3)(as_float((head.w & 255u) << 23), as_float((head.w >> 8 & 255u) << 23), as_float((head.w >> 16 & 255u) << 23));
    float3 corner = (float3)(as_float(head.x), as_float(head.y), as_float(head.z)) - ray->o;
    float3 slack = copysign(fabs(corner) * 0x1p-22f, ray->inverse_d);
    grid.near = corner - slack;
    grid.far = corner + slack;
    return grid;
}

static inline float4 cwbvh_distance(uint steps, float step, float corner, float inverse_d)
{
    return (convert_float4(as_uchar4(steps)) * step + corner) * inverse_d;
}

// Four of the boxes, each plane a byte: which does the ray meet within t_max? fmax and fmin drop the NaN of 0 × infinity.
static inline int4 cwbvh_meets(const cwbvh_ray_t *ray, const cwbvh_grid_t *grid, uint3 low, uint3 high, float t_max)
{
    uint x = ray->octant & 4u, y = ray->octant & 2u, z = ray->octant & 1u;
    float4 near = fmax(cwbvh_distance(x ? low.x : high.x, grid->step.x, grid->near.x, ray->inverse_d.x), (float4)(0.0f));
    float4 far = fmin(cwbvh_distance(x ? high.x : low.x, grid->step.x, grid->far.x, ray->inverse_d.x), (float4)(t_max));
    near = fmax(cwbvh_distance(y ? low.y : high.y, grid->step.y, grid->near.y, ray->inverse_d.y), near);
    far = fmin(cwbvh_distance(y ? high.y : low.y, grid->step.y, grid->far.y, ray->inverse_d.y), far);
    near = fmax(cwbvh_distance(z ? low.z : high.z, grid->step.z, grid->near.z, ray->inverse_d.z), near);
    far = fmin(cwbvh_distance(z ? high.z : low.z, grid->step.z, grid->far.z, ray->inverse_d.z), far);
    return near <= far * SLAB_MARGIN;
}

// What four slots that are met give: a leaf a bit a primitive, at its place; a node one of bits 24 to 31, the higher the sooner it is to be visited.
static inline uint cwbvh_bits(uint slots, uint octant, int4 met)
{
    uint nodes = (slots & slots << 1) >> 4 & 0x01010101u;  // of the places, only 24 and above have bits 4 and 3
    uint at = (slots ^ (octant * nodes)) & 0x1f1f1f1fu, bits = slots >> 5 & 0x07070707u;
    return (met.x ? (bits & 7u) << (at & 31u) : 0u) | (met.y ? (bits >> 8 & 7u) << (at >> 8 & 31u) : 0u)
         | (met.z ? (bits >> 16 & 7u) << (at >> 16 & 31u) : 0u) | (met.w ? (bits >> 24) << (at >> 24) : 0u);
}

static inline uint cwbvh_test(const cwbvh_ray_t *ray, global const uint4 *node, uint4 head, uint4 children, float t_max)
{
    cwbvh_grid_t grid = cwbvh_grid(ray, head);
    uint4 a = node[2], b = node[3], c = node[4];
    int4 first = cwbvh_meets(ray, &grid, (uint3)(a.x, a.z, b.x), (uint3)(b.z, c.x, c.z), t_max);
    int4 last = cwbvh_meets(ray, &grid, (uint3)(a.y, a.w, b.y), (uint3)(b.w, c.y, c.w), t_max);
    return cwbvh_bits(children.z, ray->octant, first) | cwbvh_bits(children.w, ray->octant, last);
}
