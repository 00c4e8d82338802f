// The point that a ray meets, and a point of a light. For one path or sixteen (lib/lanes.cl).

#include "lib/math.cl"

typedef struct {
    float3 p;       // world space
    float3 error;   // |p − true point| ≤ error, per coordinate
    float3 ng;      // geometric normal, unit, out of the front side
    float3 ns;      // shading normal, unit, on the side of ng
#ifdef SURFACE_UV
    float2 uv;
#endif
#ifdef SURFACE_TANGENT
    float3 dpdu;    // not unit; 0 where there is none
    float3 dpdv;
#endif
#ifdef RAY_CONES
    float footprint;  // area that the ray stands for, m²; 0: a point
#endif
#ifdef VERTEX_NORMALS
    float3 lift_above;  // from p to the smooth surface that the vertices' normals stand for, where that is on ng's side
    float3 lift_below;  // or on the other
#endif
#ifdef SURFACE_COLOR
    float3 color;   // of the vertices, white where there is none
#endif
} surface_t;

typedef struct {
    surface_t surface;
    float pdf;      // over solid angle at the reference point; 0: the sample failed
} light_point_t;

// Density over area → over solid angle seen from `reference` (PBR 4ed, eq. 4.17).
static inline float area_to_solid_angle(float pdf, float3 reference, const surface_t *surface)
{
    const float3 w = subtract3(surface->p, reference);
    const float distance2 = dot3(w, w), cosine = absolute(dot3(surface->ng, w)) / sqrt(distance2);
    return cosine > 0.0f && distance2 > 0.0f ? pdf * distance2 / cosine : 0.0f;
}

static inline surface_t surface_new(float3 p, float3 error, float3 normal)
{
    surface_t s;
    s.p = p;
    s.error = error;
    s.ng = normal;
    s.ns = normal;
#ifdef SURFACE_UV
    s.uv = float2_of(0.0f, 0.0f);
#endif
#ifdef SURFACE_TANGENT
    s.dpdu = float3_of(0.0f, 0.0f, 0.0f);
    s.dpdv = float3_of(0.0f, 0.0f, 0.0f);
#endif
#ifdef RAY_CONES
    s.footprint = 0.0f;
#endif
#ifdef VERTEX_NORMALS
    s.lift_above = float3_of(0.0f, 0.0f, 0.0f);
    s.lift_below = float3_of(0.0f, 0.0f, 0.0f);
#endif
#ifdef SURFACE_COLOR
    s.color = float3_of(1.0f, 1.0f, 1.0f);
#endif
    return s;
}
