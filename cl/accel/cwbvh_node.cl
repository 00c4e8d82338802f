// A ray against the eight quantised boxes of a node of 80 bytes, conservatively. lumiere/accel/cwbvh.py says what is in its five uint4.

#include "accel/slab.cl"
#include "lib/ray.cl"

#define CWBVH_FIRST_INNER 0x01000000u  // the lowest of the bits that stand for nodes, in what a node's test gives

typedef struct {
    float3 o;
    float3 inverse_d;
    uint octant;  // bits 2, 1, 0: the ray goes up along x, y, z, and so meets slots without that bit first
} cwbvh_ray_t;

// No component of the direction is taken for less than 2^-40 of the largest, so that inverses are finite: where a ray is in a node, this moves it by
// at most 2^-40 of how far the node's farthest corner is along any axis, D.
static inline cwbvh_ray_t cwbvh_prepare(const ray_t *ray)
{
    float3 size = fabs(ray->d);
    float least = fmax(size.x, fmax(size.y, size.z)) * 0x1p-40f;
    cwbvh_ray_t prepared;
    prepared.o = ray->o;
    prepared.inverse_d = 1.0f / copysign(fmax(size, least), ray->d);
    prepared.octant = (prepared.inverse_d.x < 0.0f ? 0u : 4u) | (prepared.inverse_d.y < 0.0f ? 0u : 2u) | (prepared.inverse_d.z < 0.0f ? 0u : 1u);
    return prepared;
}

// A node's grid along the ray: distances of a step, and of the corner as the near and as the far planes see it.
//
// A plane's distance is step × number + corner. Roundings: of the corner less the origin, less the slack, times the inverse, and of the product with
// the number, each by at most 2^-24 D over the direction: the slack, 2^-21 D, is twice that and what moving the ray may need. The sum's and the
// inverse's are relative to the distance, as in slab_enter, and SLAB_MARGIN's to answer for. What overflows is NaN, or as far as it should be.
typedef struct {
    float3 step;
    float3 near;
    float3 far;
} cwbvh_grid_t;

static inline cwbvh_grid_t cwbvh_grid(const cwbvh_ray_t *ray, uint4 head)
{
    float3 step = (float3)(as_float((head.w & 255u) << 23), as_float((head.w >> 8 & 255u) << 23), as_float((head.w >> 16 & 255u) << 23));
    float3 corner = (float3)(as_float(head.x), as_float(head.y), as_float(head.z)) - ray->o;
    float3 farthest = fabs(corner) + 255.0f * step;
    float3 slack = copysign((float3)(fmax(farthest.x, fmax(farthest.y, farthest.z)) * 0x1p-21f), ray->inverse_d);
    cwbvh_grid_t grid;
    grid.step = step * ray->inverse_d;
    grid.near = (corner - slack) * ray->inverse_d;
    grid.far = (corner + slack) * ray->inverse_d;
    return grid;
}

static inline float4 cwbvh_distance(uint numbers, float step, float corner)
{
    return convert_float4(as_uchar4(numbers)) * step + corner;
}

// Four of the boxes, each plane a byte: which does the ray meet within t_max? fmax and fmin drop NaN.
static inline int4 cwbvh_meets(const cwbvh_ray_t *ray, const cwbvh_grid_t *grid, uint3 low, uint3 high, float t_max)
{
    uint x = ray->octant & 4u, y = ray->octant & 2u, z = ray->octant & 1u;
    float4 near = fmax(cwbvh_distance(x ? low.x : high.x, grid->step.x, grid->near.x), (float4)(0.0f));
    float4 far = fmin(cwbvh_distance(x ? high.x : low.x, grid->step.x, grid->far.x), (float4)(t_max));
    near = fmax(cwbvh_distance(y ? low.y : high.y, grid->step.y, grid->near.y), near);
    far = fmin(cwbvh_distance(y ? high.y : low.y, grid->step.y, grid->far.y), far);
    near = fmax(cwbvh_distance(z ? low.z : high.z, grid->step.z, grid->near.z), near);
    far = fmin(cwbvh_distance(z ? high.z : low.z, grid->step.z, grid->far.z), far);
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
