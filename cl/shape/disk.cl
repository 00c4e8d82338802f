// Disks and, under a stretching transform, ellipses: centre + a axis_u + b axis_v with a² + b² ≤ 1.

#include "lib/math.cl"
#include "lib/ray.cl"
#include "lib/surface.cl"
#include "lib/warp.cl"

typedef struct {
    int unused;
} disk_ray_t;

static inline disk_ray_t disk_prepare(const ray_t *ray)
{
    disk_ray_t prepared = {0};
    return prepared;
}

static inline bool disk_intersect(const scene_t *scene, uint index, const ray_t *ray, const disk_ray_t *prepared, float t_max, hit_t *hit)
{
    global const disk_record_t *disk = scene->disks + index;
    float3 axis_u = load3(disk->axis_u), axis_v = load3(disk->axis_v);
    float3 normal = cross(axis_u, axis_v);
    float3 to_center = load3(disk->center) - ray->o;
    float height = dot(to_center, normal), slope = dot(ray->d, normal);
    // An origin whose height may be rounding lies on the disk.
    if (!(fabs(height) > GAMMA(8) * dot(fabs(to_center), fabs(normal))))
        return false;
    float t = height / slope;
    if (!(t > 0.0f && t < t_max))
        return false;
    float3 q = t * ray->d - to_center;
    float scale = 1.0f / dot(normal, normal);
    float a = dot(cross(q, axis_v), normal) * scale, b = dot(cross(axis_u, q), normal) * scale;
    if (!(a * a + b * b <= 1.0f))
        return false;
    hit->t = t;
    hit->u = a;
    hit->v = b;
    return true;
}

static inline surface_t disk_point(global const disk_record_t *disk, float a, float b)
{
    float3 axis_u = load3(disk->axis_u), axis_v = load3(disk->axis_v), center = load3(disk->center);
    float3 u = a * axis_u, v = b * axis_v;
    surface_t s = surface_new(center + u + v, GAMMA(4) * (fabs(center) + fabs(u) + fabs(v)), normalize(cross(axis_u, axis_v)));
#ifdef SURFACE_UV
    s.uv = 0.5f * (float2)(a + 1.0f, b + 1.0f);
#endif
#ifdef SURFACE_TANGENT
    s.dpdu = 2.0f * axis_u;
    s.dpdv = 2.0f * axis_v;
#endif
    return s;
}

static inline surface_t disk_surface(const scene_t *scene, uint index, const ray_t *ray, const hit_t *hit)
{
    return disk_point(scene->disks + index, hit->u, hit->v);
}

static inline float disk_area(global const disk_record_t *disk)
{
    return PI * length(cross(load3(disk->axis_u), load3(disk->axis_v)));
}

// Uniform over the area by the concentric map (Shirley & Chiu 1997).
static inline light_point_t disk_sample(const scene_t *scene, uint index, float3 reference, float2 u)
{
    global const disk_record_t *disk = scene->disks + index;
    float2 d = square_to_disk(u);
    light_point_t point;
    point.surface = disk_point(disk, d.x, d.y);
    point.pdf = area_to_solid_angle(1.0f / disk_area(disk), reference, &point.surface);
    return point;
}

static inline float disk_sample_pdf(const scene_t *scene, uint index, float3 reference, const surface_t *surface)
{
    return area_to_solid_angle(1.0f / disk_area(scene->disks + index), reference, surface);
}
