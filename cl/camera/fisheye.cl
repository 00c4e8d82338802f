// Equidistant fisheye: the angle to the axis is proportional to the distance from the centre. Beyond 180° there is no ray.

#include "lib/math.cl"

static inline bool camera_ray(global const camera_t *camera, float2 at, float2 lens, float3 *origin, float3 *direction)
{
    float2 angle = (float2)((2.0f * at.x - 1.0f) * camera->half_angle[0], (1.0f - 2.0f * at.y) * camera->half_angle[1]);
    float theta = length(angle);
    if (theta > PI)
        return false;
    float2 around = theta > 0.0f ? angle / theta : (float2)(0.0f);
    *origin = (float3)(0.0f);
    *direction = (float3)(sin(theta) * around, -cos(theta));
    return true;
}
