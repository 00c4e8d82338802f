// The pinhole camera. `at` is the point on the film: (0, 0) the top left, (1, 1) the bottom right of the whole picture.
// For one path or sixteen (lib/lanes.cl).

#include "lib/math.cl"

static inline bool camera_ray(global const camera_t *camera, float2 at, float2 lens, float3 *origin, float3 *direction)
{
    *origin = float3_of(0.0f, 0.0f, 0.0f);
    *direction = unit3(float3_of((2.0f * at.x - 1.0f) * camera->half_extent[0], (1.0f - 2.0f * at.y) * camera->half_extent[1], -1.0f));
    return true;
}
