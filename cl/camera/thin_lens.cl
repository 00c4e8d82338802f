// The thin lens (Cook, Porter & Carpenter 1984; PBR 4ed, §5.2.3): every ray through a point of the plane in focus meets the film at one point.

#include "lib/math.cl"
#include "lib/warp.cl"

// Uniform in a regular polygon of unit circumradius: one of its triangles, then a point in it.
static inline float2 square_to_polygon(float2 u, float blades)
{
    float scaled = u.x * blades;
    float blade = floor(scaled);
    float2 v = (float2)(scaled - blade, u.y);
    float r = sqrt(v.y);
    float first = 2.0f * PI * blade / blades, second = 2.0f * PI * (blade + 1.0f) / blades;
    return r * ((1.0f - v.x) * (float2)(cos(first), sin(first)) + v.x * (float2)(cos(second), sin(second)));
}

static inline bool camera_ray(global const camera_t *camera, float2 at, float2 lens, float3 *origin, float3 *direction)
{
    float3 through = (float3)((2.0f * at.x - 1.0f) * camera->half_extent[0], (1.0f - 2.0f * at.y) * camera->half_extent[1], -1.0f);
    float2 disk = camera->blades > 0.0f ? square_to_polygon(lens, camera->blades) : square_to_disk(lens);
    *origin = (float3)(camera->aperture_radius * disk, 0.0f);
    *direction = normalize(camera->focus_distance * through - *origin);
    return true;
}
