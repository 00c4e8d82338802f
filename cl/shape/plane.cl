// Infinite planes.

#include "lib/math.cl"
#include "lib/ray.cl"
#include "lib/surface.cl"

typedef struct {
    int unused;
} plane_ray_t;

static inline plane_ray_t plane_prepare(const ray_t *ray)
{
    plane_ray_t prepared = {0};
    return prepared;
}

static inline bool plane_intersect(const scene_t *scene, uint index, const ray_t *ray, const plane_ray_t *prepared, float t_max, hit_t *hit)
{
    global const plane_record_t *plane = scene->planes + index;
    float3 normal = load3(plane->normal), to_point = load3(plane->point) - ray->o;
    float height = dot(to_point, normal);
    // An origin whose height may be rounding lies on the plane.
    if (!(fabs(height) > GAMMA(8) * dot(fabs(to_point), fabs(normal))))
        return false;
    float t = height / dot(ray->d, normal);
    if (!(t > 0.0f && t < t_max))
        return false;
    hit->t = t;
    hit->u = 0.0f;
    hit->v = 0.0f;
    return true;
}

static inline surface_t plane_surface(const scene_t *scene, uint index, const ray_t *ray, const hit_t *hit)
{
    global const plane_record_t *plane = scene->planes + index;
    float3 normal = load3(plane->normal), point = load3(plane->point);
    float3 from_point = ray->o - point + hit->t * ray->d;
    // Brought back onto the plane; what is left is the rounding of that projection and of the two sums.
    float3 error = GAMMA(4) * (fabs(from_point) + fabs(normal) * dot(fabs(from_point), fabs(normal)));
    from_point -= normal * dot(from_point, normal);
    float3 p = point + from_point;
    surface_t s = surface_new(p, error + GAMMA(1) * fabs(p), normal);
#ifdef SURFACE_UV
    float3 tangent = load3(plane->tangent), bitangent = cross(normal, tangent);
    s.uv = (float2)(dot(from_point, tangent), dot(from_point, bitangent));
#ifdef SURFACE_TANGENT
    s.dpdu = tangent;
    s.dpdv = bitangent;
#endif
#endif
    return s;
}

// A plane has no area to sample: it is a light only to the rays that meet it.
static inline light_point_t plane_sample(const scene_t *scene, uint index, float3 reference, float2 u)
{
    light_point_t point;
    point.surface = surface_new(reference, (float3)(0.0f), (float3)(0.0f, 0.0f, 1.0f));
    point.pdf = 0.0f;
    return point;
}

static inline float plane_sample_pdf(const scene_t *scene, uint index, float3 reference, const surface_t *surface)
{
    return 0.0f;
}
