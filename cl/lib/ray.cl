// Rays, and what they meet.

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
    return all(isfinite(ray->o)) && all(isfinite(ray->d)) && any(ray->d != (float3)(0.0f));
}
