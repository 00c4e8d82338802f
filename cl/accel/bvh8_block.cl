// A ray against a block of eight triangles: the watertight test of shape/triangle_test.cl, eight at a time.

#include "accel/bvh8_node.cl"
#include "shape/triangle_test.cl"

typedef struct {
    bvh8_floats_t t, u, v;
    ulong met;    // lanes that the ray meets at 0 < t < t_max
    ulong doubt;  // lanes to be decided by triangle_intersect: an edge function is 0, or products may have over- or underflowed
} bvh8_block_t;

static inline float8 bvh8_abs(float8 x)
{
    return as_float8(as_int8(x) & 0x7fffffff);
}

static inline void bvh8_block_test(const triangle_ray_t *ray, global const float *block, float t_max, bvh8_block_t *result)
{
#pragma OPENCL FP_CONTRACT OFF
    global const float8 *v = (global const float8 *)block;
    uint3 axis = ray->axis;
    float8 az = v[axis.z] - ray->o.z, bz = v[3 + axis.z] - ray->o.z, cz = v[6 + axis.z] - ray->o.z;
    float8 a0x = v[axis.x] - ray->o.x, a0y = v[axis.y] - ray->o.y;
    float8 ax = a0x - ray->shear.x * az, ay = a0y - ray->shear.y * az;
    float8 bx = (v[3 + axis.x] - ray->o.x) - ray->shear.x * bz, by = (v[3 + axis.y] - ray->o.y) - ray->shear.y * bz;
    float8 cx = (v[6 + axis.x] - ray->o.x) - ray->shear.x * cz, cy = (v[6 + axis.y] - ray->o.y) - ray->shear.y * cz;
    float8 edge_a = cx * by - cy * bx, edge_b = ax * cy - ay * cx, edge_c = bx * ay - by * ax;
    float8 least = edge_a < edge_b ? edge_a : edge_b, most = edge_a > edge_b ? edge_a : edge_b;
    least = edge_c < least ? edge_c : least;
    most = edge_c > most ? edge_c : most;
    int8 inside = ~((least < 0.0f) & (most > 0.0f));  // NaN, of products that overflowed, is left in doubt
    result->met = bvh8_lanes(inside);
    result->doubt = 0UL;
    if (result->met == 0UL)
        return;
    float8 determinant = edge_a + edge_b + edge_c, size = bvh8_abs(determinant);
    const ulong on_edge = bvh8_lanes((edge_a == 0.0f) | (edge_b == 0.0f) | (edge_c == 0.0f));
    const ulong sized = bvh8_lanes((size > 0x1p-100f) & (size < 0x1p100f));
    // The plane through the vertices: the origin's height over it, with the bound of its rounding, and t (see triangle_intersect).
    float8 e1x = v[3 + axis.x] - v[axis.x], e1y = v[3 + axis.y] - v[axis.y], e1z = v[3 + axis.z] - v[axis.z];
    float8 e2x = v[6 + axis.x] - v[axis.x], e2y = v[6 + axis.y] - v[axis.y], e2z = v[6 + axis.z] - v[axis.z];
    float8 yz = e1y * e2z, zy = e1z * e2y, zx = e1z * e2x, xz = e1x * e2z, xy = e1x * e2y, yx = e1y * e2x;
    float8 nx = yz - zy, ny = zx - xz, nz = xy - yx;
    float8 height = a0x * nx + a0y * ny + az * nz;
    float8 error = (bvh8_abs(a0x) * (bvh8_abs(yz) + bvh8_abs(zy)) + bvh8_abs(a0y) * (bvh8_abs(zx) + bvh8_abs(xz))
                    + bvh8_abs(az) * (bvh8_abs(xy) + bvh8_abs(yx))) * (8.0f * 0x1p-24f);
    float8 slope = ray->shear.x * nx + ray->shear.y * ny + nz;
    float8 z = height / slope, low = az < bz ? az : bz, high = az > bz ? az : bz;
    low = cz < low ? cz : low;
    high = cz > high ? cz : high;
    z = z < low ? low : z;
    z = z > high ? high : z;
    float8 t = z * ray->shear.z;
    float8 area = bvh8_abs(nx) + bvh8_abs(ny) + bvh8_abs(nz);
    // Heights are products of three: where their parts under- or overflow, so does the bound of their rounding, nearly.
    const ulong ranged = bvh8_lanes((area > 0x1p-100f) & (area < 0x1p100f) & (error > 0x1p-120f) & (error < 0x1p100f));
    const ulong sure = sized & ~on_edge & ranged;
    result->doubt = result->met & ~sure;
    result->met &= sure & bvh8_lanes((bvh8_abs(height) > error) & (t > 0.0f) & (t < t_max));
    result->t.all = t;
    result->u.all = edge_b / determinant;
    result->v.all = edge_c / determinant;
}
