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

// No other ray meets anything: an origin or direction that is not finite, or no direction at all, would visit every node. By bits without the sign,
// among which infinity is 0xff000000: isfinite, all and any are calls on some runtimes, across which no vector stays in a register.
static inline bool ray_is_valid(const ray_t *ray)
{
    const uint3 o = as_uint3(ray->o) << 1, d = as_uint3(ray->d) << 1;
    return o.x < 0xff000000u && o.y < 0xff000000u && o.z < 0xff000000u && d.x < 0xff000000u && d.y < 0xff000000u && d.z < 0xff000000u
           && (d.x | d.y | d.z) != 0u;
}
