// The orthographic camera.

static inline bool camera_ray(global const camera_t *camera, float2 at, float2 lens, float3 *origin, float3 *direction)
{
    *origin = (float3)((2.0f * at.x - 1.0f) * camera->half_extent[0], (1.0f - 2.0f * at.y) * camera->half_extent[1], 0.0f);
    *direction = (float3)(0.0f, 0.0f, -1.0f);
    return true;
}
