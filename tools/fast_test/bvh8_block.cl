// In place of accel/bvh8_block.cl, to measure what the watertight test costs (tools/benchmark_rays.py): Möller & Trumbore 1997, "Fast, Minimum Storage
// Ray/Triangle Intersection", eight triangles at a time, on blocks that hold vertex 0 and the edges from it to the other two. One division, of what
// is surely met. A ray may pass between two triangles that share an edge, and may meet the triangle that it leaves.

#include "accel/bvh8_node.cl"
#include "shape/triangle_test.cl"

typedef struct {
    bvh8_floats_t t, u, v;
    ulong met;
    ulong doubt;
} bvh8_block_t;

static inline void bvh8_block_test(const triangle_ray_t *ray, global const float *block, float t_max, bvh8_block_t *result)
{
    global const float8 *v = (global const float8 *)block;
    float8 cx = v[0] - ray->o.x, cy = v[1] - ray->o.y, cz = v[2] - ray->o.z;
    float8 e1x = v[3], e1y = v[4], e1z = v[5], e2x = v[6], e2y = v[7], e2z = v[8];
    float8 rx = cy * ray->d.z - cz * ray->d.y, ry = cz * ray->d.x - cx * ray->d.z, rz = cx * ray->d.y - cy * ray->d.x;
    float8 nx = e1y * e2z - e1z * e2y, ny = e1z * e2x - e1x * e2z, nz = e1x * e2y - e1y * e2x;
    float8 determinant = nx * ray->d.x + ny * ray->d.y + nz * ray->d.z;
    int8 sign = as_int8(determinant) & (int)0x80000000;
    float8 size = as_float8(as_int8(determinant) ^ sign);
    float8 u = as_float8(as_int8(rx * e2x + ry * e2y + rz * e2z) ^ sign);
    float8 w = as_float8(as_int8(-(rx * e1x + ry * e1y + rz * e1z)) ^ sign);
    float8 t = as_float8(as_int8(cx * nx + cy * ny + cz * nz) ^ sign);
    result->met = bvh8_lanes((u >= 0.0f) & (w >= 0.0f) & (u + w <= size) & (t > 0.0f) & (t < size * t_max));
    result->doubt = 0UL;
    if (result->met == 0UL)
        return;
    float8 inverse = 1.0f / size;
    result->t.all = t * inverse;
    result->u.all = u * inverse;
    result->v.all = w * inverse;
}
