// Rays, and what they meet. For one path or sixteen (lib/lanes.cl).

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
    const uint ox = as_uint(ray->o.x) << 1, oy = as_uint(ray->o.y) << 1, oz = as_uint(ray->o.z) << 1;
    const uint dx = as_uint(ray->d.x) << 1, dy = as_uint(ray->d.y) << 1, dz = as_uint(ray->d.z) << 1;
    return ox < 0xff000000u && oy < 0xff000000u && oz < 0xff000000u && dx < 0xff000000u && dy < 0xff000000u && dz < 0xff000000u
           && (dx | dy | dz) != 0u;
}
