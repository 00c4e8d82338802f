// Ellipsoids: the unit sphere under a linear map.

#include "lib/circle.cl"
#include "lib/math.cl"
#include "lib/ray.cl"
#include "lib/roots.cl"
#include "lib/surface.cl"

typedef struct {
    int unused;
} ellipsoid_ray_t;

static inline ellipsoid_ray_t ellipsoid_prepare(const ray_t *ray)
{
    ellipsoid_ray_t prepared = {0};
    return prepared;
}

// As sphere_roots, in the space where it is the unit sphere; the map there adds its rounding to that of c.
static inline bool ellipsoid_roots(const scene_t *scene, uint index, const ray_t *ray, roots_t *roots)
{
    global const ellipsoid_record_t *ellipsoid = scene->ellipsoids + index;
    float3 from_center = ray->o - load3(ellipsoid->center);
    float3 f = rotate3(&ellipsoid->to_local[0], from_center), d = rotate3(&ellipsoid->to_local[0], ray->d);
    float a = dot(d, d), b = -dot(f, d);
    float3 nearest = f + (b / a) * d;
    float discriminant = 1.0f - dot(nearest, nearest);
    if (!(discriminant >= 0.0f))
        return false;
    float f2 = dot(f, f), c = f2 - 1.0f;
    float q = b + copysign(sqrt(a * discriminant), b);
    float3 terms = (float3)(dot(fabs(load3(ellipsoid->to_local)), fabs(from_center)), dot(fabs(load3(ellipsoid->to_local + 3)), fabs(from_center)),
                            dot(fabs(load3(ellipsoid->to_local + 6)), fabs(from_center)));
    *roots = roots_new(c / q, q / a, (GAMMA(8) * (f2 + 1.0f) + GAMMA(12) * dot(terms, fabs(f))) / fabs(q));
    return true;
}

static inline bool ellipsoid_intersect(const scene_t *scene, uint index, const ray_t *ray, const ellipsoid_ray_t *prepared, float t_max, hit_t *hit)
{
    roots_t roots;
    return ellipsoid_roots(scene, index, ray, &roots) && roots_first(&roots, t_max, hit);
}

#define ellipsoid_meets_twice 1
static inline bool ellipsoid_intersect_again(const scene_t *scene, uint index, const ray_t *ray, const ellipsoid_ray_t *prepared, float t_max,
                                             hit_t *hit)
{
    roots_t roots;
    return ellipsoid_roots(scene, index, ray, &roots) && roots_second(&roots, t_max, hit);
}

// The point of the unit sphere along `offset`, in the world.
static inline surface_t ellipsoid_point(global const ellipsoid_record_t *ellipsoid, float3 offset)
{
    float3 n = normalize(offset);
    float3 from_center = rotate3(&ellipsoid->to_world[0], n);
    float3 p = load3(ellipsoid->center) + from_center;
    float3 terms = (float3)(dot(fabs(load3(ellipsoid->to_world)), fabs(n)), dot(fabs(load3(ellipsoid->to_world + 3)), fabs(n)),
                            dot(fabs(load3(ellipsoid->to_world + 6)), fabs(n)));
    surface_t s = surface_new(p, GAMMA(12) * terms + GAMMA(1) * fabs(p), normalize(rotate3_back(&ellipsoid->to_local[0], n)));
#ifdef SURFACE_UV
    s.uv = (float2)(0.5f + atan2(n.x, n.z) * INV_TWO_PI, 1.0f - acos(clamp(n.y, -1.0f, 1.0f)) * INV_PI);
#ifdef SURFACE_TANGENT
    float3 along_u = (float3)(n.z, 0.0f, -n.x);
    s.dpdu = 2.0f * PI * rotate3(&ellipsoid->to_world[0], along_u);
    s.dpdv = PI * rotate3(&ellipsoid->to_world[0], cross(n, along_u));
#endif
#endif
    return s;
}

static inline surface_t ellipsoid_surface(const scene_t *scene, uint index, const ray_t *ray, const hit_t *hit)
{
    global const ellipsoid_record_t *ellipsoid = scene->ellipsoids + index;
    return ellipsoid_point(ellipsoid, rotate3(&ellipsoid->to_local[0], ray->o - load3(ellipsoid->center) + hit->t * ray->d));
}

// Density over the area at the image of n where n is uniform on the unit sphere: a patch there grows by |det M| |M⁻ᵀ n|.
static inline float ellipsoid_area_density(global const ellipsoid_record_t *ellipsoid, float3 n)
{
    return 0.5f * INV_TWO_PI / (ellipsoid->volume * length(rotate3_back(&ellipsoid->to_local[0], n)));
}

static inline light_point_t ellipsoid_sample(const scene_t *scene, uint index, float3 reference, float2 u)
{
    global const ellipsoid_record_t *ellipsoid = scene->ellipsoids + index;
    float z = 1.0f - 2.0f * u.x, r = sqrt(fmax(0.0f, 1.0f - z * z));
    float3 n = (float3)(r * circle_point(u.y), z);
    light_point_t point;
    point.surface = ellipsoid_point(ellipsoid, n);
    point.pdf = area_to_solid_angle(ellipsoid_area_density(ellipsoid, n), reference, &point.surface);
    return point;
}

static inline float ellipsoid_sample_pdf(const scene_t *scene, uint index, float3 reference, const surface_t *surface)
{
    global const ellipsoid_record_t *ellipsoid = scene->ellipsoids + index;
    float3 n = normalize(rotate3(&ellipsoid->to_local[0], surface->p - load3(ellipsoid->center)));
    return area_to_solid_angle(ellipsoid_area_density(ellipsoid, n), reference, surface);
}
