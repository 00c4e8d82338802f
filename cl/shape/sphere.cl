// Spheres.

#include "lib/circle.cl"
#include "lib/math.cl"
#include "lib/frame.cl"
#include "lib/ray.cl"
#include "lib/roots.cl"
#include "lib/surface.cl"

typedef struct {
    float a;  // d · d
} sphere_ray_t;

static inline sphere_ray_t sphere_prepare(const ray_t *ray)
{
    sphere_ray_t prepared;
    prepared.a = dot(ray->d, ray->d);
    return prepared;
}

// The discriminant comes from the distance of the centre to the line, the nearer root from the product of the roots: neither cancels for a small
// sphere far away (Haines, Günther & Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection").
static inline bool sphere_roots(const scene_t *scene, uint index, const ray_t *ray, const sphere_ray_t *prepared, roots_t *roots)
{
    global const sphere_record_t *sphere = scene->spheres + index;
    float r2 = sphere->radius * sphere->radius;
    float3 f = ray->o - load3(sphere->center);
    float b = -dot(f, ray->d);
    float3 nearest = f + (b / prepared->a) * ray->d;
    float discriminant = r2 - dot(nearest, nearest);
    if (!(discriminant >= 0.0f))
        return false;
    float f2 = dot(f, f);
    float c = f2 - r2;
    float q = b + copysign(sqrt(prepared->a * discriminant), b);
    // c is only known to within its rounding.
    *roots = roots_new(c / q, q / prepared->a, GAMMA(8) * (f2 + r2) / fabs(q));
    return true;
}

static inline bool sphere_intersect(const scene_t *scene, uint index, const ray_t *ray, const sphere_ray_t *prepared, float t_max, hit_t *hit)
{
    roots_t roots;
    return sphere_roots(scene, index, ray, prepared, &roots) && roots_first(&roots, t_max, hit);
}

#define sphere_meets_twice 1
static inline bool sphere_intersect_again(const scene_t *scene, uint index, const ray_t *ray, const sphere_ray_t *prepared, float t_max, hit_t *hit)
{
    roots_t roots;
    return sphere_roots(scene, index, ray, prepared, &roots) && roots_second(&roots, t_max, hit);
}

// The point `offset` from the centre, brought back onto the sphere.
static inline surface_t sphere_point(global const sphere_record_t *sphere, float3 offset)
{
    float3 normal = normalize(offset);
    offset = sphere->radius * normal;
    float3 p = load3(sphere->center) + offset;
    surface_t s = surface_new(p, GAMMA(5) * fabs(offset) + GAMMA(1) * fabs(p), normal);
#ifdef SURFACE_UV
    float3 n = rotate3(&sphere->to_local[0], normal);
    s.uv = (float2)(0.5f + atan2(n.x, n.z) * INV_TWO_PI, 1.0f - acos(clamp(n.y, -1.0f, 1.0f)) * INV_PI);
#ifdef SURFACE_TANGENT
    s.dpdu = 2.0f * PI * sphere->radius * rotate3_back(&sphere->to_local[0], (float3)(n.z, 0.0f, -n.x));
    s.dpdv = 0.5f * cross(normal, s.dpdu);
#endif
#endif
    return s;
}

static inline surface_t sphere_surface(const scene_t *scene, uint index, const ray_t *ray, const hit_t *hit)
{
    global const sphere_record_t *sphere = scene->spheres + index;
    return sphere_point(sphere, ray->o - load3(sphere->center) + hit->t * ray->d);
}

// 1 − cos of the half angle of the cone in which a sphere is seen from outside, without cancellation.
static inline float sphere_one_minus_cos(float r2, float distance2)
{
    float sin2 = r2 / distance2;
    return sin2 / (1.0f + sqrt(fmax(0.0f, 1.0f - sin2)));
}

// Is a point at this squared distance from the centre outside by more than rounding? A point of the sphere itself has no cone in which it is seen.
static inline bool sphere_is_outside(global const sphere_record_t *sphere, float distance2)
{
    float rounding = 16.0f * MACHINE_EPSILON * (max_component(fabs(load3(sphere->center))) + sphere->radius);
    return sqrt(distance2) > sphere->radius + rounding;
}

// From outside: uniform in the cone that it fills; from inside: uniform over the area (Shirley & Wang 1996; PBR 4ed, §6.2.4).
static inline light_point_t sphere_sample(const scene_t *scene, uint index, float3 reference, float2 u)
{
    global const sphere_record_t *sphere = scene->spheres + index;
    float r2 = sphere->radius * sphere->radius;
    float3 to_center = load3(sphere->center) - reference;
    float distance2 = dot(to_center, to_center);
    float2 around = circle_point(u.y);
    light_point_t point;
    if (!sphere_is_outside(sphere, distance2)) {
        float z = 1.0f - 2.0f * u.x, r = sqrt(fmax(0.0f, 1.0f - z * z));
        point.surface = sphere_point(sphere, (float3)(r * around, z));
        point.pdf = area_to_solid_angle(1.0f / (4.0f * PI * r2), reference, &point.surface);
        return point;
    }
    float one_minus_cos_max = sphere_one_minus_cos(r2, distance2);
    float one_minus_cos = u.x * one_minus_cos_max;
    float sin2 = one_minus_cos * (2.0f - one_minus_cos);
    float sine = sqrt(sin2), distance = sqrt(distance2);
    frame_t frame = frame_about(to_center / distance);
    float3 w = frame_to_world(&frame, (float3)(sine * around, 1.0f - one_minus_cos));
    float t = distance * (1.0f - one_minus_cos) - sqrt(fmax(0.0f, r2 - distance2 * sin2));
    point.surface = sphere_point(sphere, t * w - to_center);
    point.pdf = INV_TWO_PI / one_minus_cos_max;
    return point;
}

static inline float sphere_sample_pdf(const scene_t *scene, uint index, float3 reference, const surface_t *surface)
{
    global const sphere_record_t *sphere = scene->spheres + index;
    float r2 = sphere->radius * sphere->radius;
    float3 to_center = load3(sphere->center) - reference;
    float distance2 = dot(to_center, to_center);
    if (!sphere_is_outside(sphere, distance2))
        return area_to_solid_angle(1.0f / (4.0f * PI * r2), reference, surface);
    return INV_TWO_PI / sphere_one_minus_cos(r2, distance2);
}
