// All directions, lat-long: the centre column is −Z, columns run to the right, rows from +Y to −Y.

#include "lib/math.cl"

static inline bool camera_ray(global const camera_t *camera, float2 at, float2 lens, float3 *origin, float3 *direction)
{
    float phi = 2.0f * PI * (at.x - 0.5f), theta = PI * at.y;
    *origin = (float3)(0.0f);
    *direction = (float3)(sin(theta) * sin(phi), cos(theta), -sin(theta) * cos(phi));
    return true;
}
