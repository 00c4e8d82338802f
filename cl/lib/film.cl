// From a pixel to the camera's ray. For one path or sixteen (lib/lanes.cl).

#include "lib/math.cl"

// The point of the film, from 0 to 1, that lies `offset` pixels from the middle of pixel (x, y).
static inline float2 film_point(global const render_t *render, uint x, uint y, float2 offset)
{
    return float2_of((convert_float(x) + 0.5f + offset.x) / (float)render->width, (convert_float(y) + 0.5f + offset.y) / (float)render->height);
}

static inline float3 camera_to_world(global const camera_t *camera, float3 v)
{
    return float3_of(camera->to_world[0] * v.x + camera->to_world[1] * v.y + camera->to_world[2] * v.z,
                     camera->to_world[4] * v.x + camera->to_world[5] * v.y + camera->to_world[6] * v.z,
                     camera->to_world[8] * v.x + camera->to_world[9] * v.y + camera->to_world[10] * v.z);
}

static inline float3 camera_position(global const camera_t *camera)
{
    return float3_of(camera->to_world[3], camera->to_world[7], camera->to_world[11]);
}
