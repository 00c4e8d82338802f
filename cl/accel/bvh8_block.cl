// A ray against a block of eight triangles, generously: what the watertight test of shape/triangle_test.cl would accept is a candidate.

#include "accel/bvh8_node.cl"
#include "shape/triangle_test.cl"

static inline ulong bvh8_block_candidates(const triangle_ray_t *ray, global const float *block, float t_max)
{
#pragma OPENCL FP_CONTRACT OFF
    global const float8 *v = (global const float8 *)block;
    uint3 axis = ray->axis;
    float8 az = v[axis.z] - ray->o.z, bz = v[3 + axis.z] - ray->o.z, cz = v[6 + axis.z] - ray->o.z;
    float8 ax = (v[axis.x] - ray->o.x) - ray->shear.x * az, ay = (v[axis.y] - ray->o.y) - ray->shear.y * az;
    float8 bx = (v[3 + axis.x] - ray->o.x) - ray->shear.x * bz, by = (v[3 + axis.y] - ray->o.y) - ray->shear.y * bz;
    float8 cx = (v[6 + axis.x] - ray->o.x) - ray->shear.x * cz, cy = (v[6 + axis.y] - ray->o.y) - ray->shear.y * cz;
    float8 u = cx * by - cy * bx, w = ax * cy - ay * cx, s = bx * ay - by * ax;
    float8 least = u < w ? u : w, most = u > w ? u : w;
    least = s < least ? s : least;
    most = s > most ? s : most;
    int8 inside = (least >= 0.0f) | (most <= 0.0f);
    // t = (u az + w bz + s cz) / (u + w + s), and how far rounding may carry it. NaN, of triangles seen edge on, stays a candidate.
    float8 determinant = u + w + s;
    float8 t = (u * az + w * bz + s * cz) * ray->shear.z / determinant;
    float8 reach = az > -az ? az : -az, reach_b = bz > -bz ? bz : -bz, reach_c = cz > -cz ? cz : -cz;
    reach = reach_b > reach ? reach_b : reach;
    reach = reach_c > reach ? reach_c : reach;
    float8 slack = reach * (fabs(ray->shear.z) * 0x1p-16f);
    int8 beyond = (t + slack < 0.0f) | (t - slack > t_max);
    return bvh8_lanes(inside & ~beyond);
}
