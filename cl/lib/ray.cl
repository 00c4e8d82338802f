// Rays, and what they meet. For one path or sixteen (lib/lanes.cl).

#include "lib/vector.cl"

typedef struct {
    float3 o;       // origin
    float3 d;       // direction; t counts its lengths
    float t_max;    // what lies at 0 < t < t_max is met
} ray_t;

typedef struct {
    float t;
    float u;        // the shape's own two coordinates of the point: for a triangle, the barycentrics of vertices 1 and 2
    float v;
    uint primitive; // over all shapes of the scene; not set where t is still the ray's t_max
} hit_t;

// No other ray meets anything: an origin or direction that is not finite, or no direction at all, would visit every node.
static inline bool ray_is_valid(const ray_t *ray)
{
    const float3 o = ray->o, d = ray->d;
    return is_finite(o.x) && is_finite(o.y) && is_finite(o.z) && is_finite(d.x) && is_finite(d.y) && is_finite(d.z)
           && (d.x != 0.0f || d.y != 0.0f || d.z != 0.0f);
}
