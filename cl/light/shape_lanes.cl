// Triangles that emit, sampled for sixteen paths.

#include "scene/lanes.cl"
#include "scene/sampler_lanes.cl"
#include "light/shape.cl"
#include "shape/triangle_lanes.cl"

static inline light_sample_t_lanes emitter_sample_lanes(const scene_t *scene, const each_uint_t *emitter, float3_lanes reference, pair_t_lanes u)
{
    each_uint_t triangle;
    each_float_t r, g, b;
    each_int_t both_sides;
    ONE_BY_ONE
    for (uint lane = 0u; lane < LANES; lane++) {
        const uint primitive = scene->emitters[emitter->lane[lane]];
        global const emission_t *emission = scene->emissions + scene->objects[scene->primitive_objects[primitive]].emission;
        triangle.lane[lane] = primitive - scene->render->triangle_first;
        r.lane[lane] = emission->radiance[0];
        g.lane[lane] = emission->radiance[1];
        b.lane[lane] = emission->radiance[2];
        both_sides.lane[lane] = emission->both_sides ? -1 : 0;
    }
    const float2_lanes at = float2_of_lanes(unit_float_lanes(u.x), unit_float_lanes(u.y));
    float16 area;
    const surface_t_lanes surface = triangle_at_lanes(scene, &triangle, square_to_triangle_lanes(at), &area);
    const float3_lanes to_reference = subtract3_lanes(reference, surface.p);
    const int16 lit = both_sides.all | (dot3_lanes(surface.ng, to_reference) > 0.0f);
    const float16 pdf = area_to_solid_angle_lanes(1.0f / area, reference, &surface);
    return light_sample_new_lanes(offset_origin_lanes(surface.p, surface.error, surface.ng, to_reference), float3_of_lanes(r.all, g.all, b.all),
                                  lit ? pdf : 0.0f, 0, 0);
}
