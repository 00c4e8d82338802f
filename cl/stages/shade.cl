// shade: at the surface that a path met, adds what it emits, samples a light for connect, and samples the BSDF for the path to go on.
// One kernel a kind of BSDF: BSDF(f) is that kind's function f (docs/architecture.md).
//
// From: extend. To: connect (a shadow ray), extend (the path goes on); else the slot is idle.

#include "lib/frame_along.cl"
#include "scene/interiors.cl"
#include "lib/lights.cl"
#include "lib/met_emission.cl"
#include "lib/offset.cl"
#include "lib/path.cl"
#include "lib/queue.cl"
#include "lib/samples.cl"
#include "lib/shapes.cl"
#include "lib/tilt.cl"
#include "scene/bsdf.cl"
#include "scene/cone.cl"
#include "scene/vertex_random.cl"

// Where the path stands: what it met, and the frame in which the BSDF works.
typedef struct {
    surface_t surface;
    frame_t frame;
    float3 wo;        // local, towards where the path came from
    uint sample;
    uint depth;       // scattering events before this one
    vertex_random_t random;
#ifdef VERTEX_NORMALS
    bool smooth;      // the point was moved off its triangle: lift_point
#endif
#ifdef SUBSURFACE
    bool inside;      // the path has come through a body
#endif
} vertex_t;

// The first surface of a path, for the AOVs that describe it.
static inline void write_first_hit(const scene_t *scene, const samples_t *samples, uint sample, float weight, const surface_t *surface,
                            float3 normal, float3 albedo, uint object_index)
{
#ifdef CHANNEL_ALBEDO
    sample_add(samples, CHANNEL_ALBEDO, sample, weight * albedo);
#endif
#ifdef CHANNEL_NORMAL
    sample_add(samples, CHANNEL_NORMAL, sample, weight * normal);
#endif
#ifdef CHANNEL_POSITION
    sample_add(samples, CHANNEL_POSITION, sample, weight * surface->p);
#endif
#ifdef CHANNEL_DEPTH
    float3 view = surface->p - (float3)(scene->camera->to_world[3], scene->camera->to_world[7], scene->camera->to_world[11]);
    sample_set(samples, CHANNEL_DEPTH, sample, weight * length(view));
#endif
#ifdef CHANNEL_UV
    sample_set(samples, CHANNEL_UV, sample, weight * surface->uv.x);
    sample_set(samples, CHANNEL_UV + 1u, sample, weight * surface->uv.y);
#endif
#ifdef CHANNEL_MATERIAL_ID
    sample_set(samples, CHANNEL_MATERIAL_ID, sample, (float)(scene->objects[object_index].material_id + 1u));
#endif
#ifdef CHANNEL_OBJECT_ID
    sample_set(samples, CHANNEL_OBJECT_ID, sample, (float)(object_index + 1u));
#endif
}

// The frame of the shading normal, on the viewer's side where the material is two-sided; `wo` is set to the local direction to the viewer.
static inline void make_frame(const scene_t *scene, global const object_t *object, float3 to_viewer, vertex_t *vertex)
{
    surface_t *s = &vertex->surface;
    bool behind = dot(to_viewer, s->ng) < 0.0f;
    if (behind && (object->flags & OBJECT_TWO_SIDED)) {
        s->ng = -s->ng;
        s->ns = -s->ns;
#ifdef VERTEX_NORMALS
        s->lift_above = s->lift_below;
#endif
        behind = false;
    }
#ifdef NORMAL_MAP
    if (object->normal_map != NO_TEXTURE)
        s->ns = normal_mapped(scene, object->normal_map, s);
#endif
#ifdef BUMP_MAP
    if (object->bump_map != NO_TEXTURE)
        s->ns = bump_mapped(scene, object->bump_map, object->bump_scale, s);
#endif
#ifdef BENT_NORMALS
    const float side = behind ? -1.0f : 1.0f;
    s->ns = side * bent_normal(side * s->ns, side * s->ng, to_viewer);
#endif
#ifdef SURFACE_TANGENT
    vertex->frame = frame_along(s->ns, s->dpdu);
#else
    vertex->frame = frame_about(s->ns);
#endif
    vertex->wo = frame_to_local(&vertex->frame, to_viewer);
}

// Light may only pass to the side of the true surface that the shading frame says (Veach 1997, §5.3).
static inline bool sides_agree(const vertex_t *vertex, float3 wi_world, float3 wi)
{
#ifdef VERTEX_NORMALS
    if (vertex->smooth)
        return wi.z > 0.0f;
#endif
    return dot(wi_world, vertex->surface.ng) * wi.z > 0.0f;
}

// Where a ray in direction w begins.
static inline float3 ray_origin(const vertex_t *vertex, float3 w)
{
    const surface_t *s = &vertex->surface;
#ifdef VERTEX_NORMALS
    if (vertex->smooth)
        return offset_origin(s->p, s->error, s->ng, s->ng);
#endif
    return offset_origin(s->p, s->error, s->ng, w);
}

#ifdef VERTEX_NORMALS
// Moves the point of a surface that scatters on the viewer's side alone to the smooth surface that its triangles stand for, from where
// those triangles cast no shadows on it; the shading normal then decides what is above.
static inline void lift_point(global const object_t *object, vertex_t *vertex)
{
    surface_t *s = &vertex->surface;
    vertex->smooth = (object->flags & OBJECT_TWO_SIDED) != 0u && any(s->lift_above != (float3)(0.0f));
    if (vertex->smooth)
        s->p += s->lift_above;
}
#endif

#ifdef SUBSURFACE
// Does light from local direction wi come through a body? Shadow rays do not: such light is left to the paths.
static inline bool through_body(const BSDF(t) *bsdf, const vertex_t *vertex, float3 wi)
{
#ifdef WALKS
    return BSDF(in_body)(bsdf, wi) || (vertex->inside && vertex->wo.z > 0.0f);
#else
    return vertex->inside;
#endif
}
#endif

#ifdef WALKS
// Takes the path that goes on along the sample into the body or out of it; says whether it is in one then.
static inline bool cross_surface(const path_t *path, uint slot, const BSDF(t) *bsdf, const vertex_t *vertex, const bsdf_sample_t *s)
{
    const bool behind = vertex->wo.z < 0.0f;
    if (s->walks && !(vertex->inside && behind)) {
        const medium_t medium = BSDF(medium)(bsdf);
        path_set_extinction(path, slot, medium.extinction);
        path_set_scattering_albedo(path, slot, medium.albedo);
        path_set_asymmetry(path, slot, medium.g);
    } else if (behind && s->wi.z > 0.0f)
        path_set_extinction(path, slot, (float3)(0.0f));
    return s->walks || (vertex->inside && !(behind && s->wi.z > 0.0f));
}
#endif

#ifdef NEXT_EVENT_ESTIMATION
// Samples a light and stores the shadow ray that connects to it; false where nothing can come of it.
static inline bool sample_light(const scene_t *scene, const path_t *path, uint slot, const BSDF(t) *bsdf, const vertex_t *vertex, float3 throughput)
{
    const pair_t u = random_light(&vertex->random);
    light_sample_t light = light_sample(scene, vertex->surface.p, (uint2)(u.x, u.y));
    if (!(light.pdf > 0.0f) || is_black(light.radiance))
        return false;
    float3 to_light = light.infinite ? light.target : normalize(light.target - vertex->surface.p);
    float3 wi = frame_to_local(&vertex->frame, to_light);
    if (!sides_agree(vertex, to_light, wi))
        return false;
#ifdef SUBSURFACE
    if (through_body(bsdf, vertex, wi))
        return false;
#endif
    float3 f = BSDF(eval)(bsdf, vertex->wo, wi);
    if (is_black(f))
        return false;
    float bsdf_pdf = BSDF(pdf)(bsdf, vertex->wo, wi);
#ifdef TRACED
    path_set_light_pdf(path, slot, light.pdf);
    path_set_light_bsdf_pdf(path, slot, bsdf_pdf);
#endif
    float weight = sampled_light_weight(&light, bsdf_pdf) / light.pdf;
    float3 contribution = throughput * f * light.radiance * weight;
    if (is_black(contribution))
        return false;
    float3 origin = ray_origin(vertex, to_light);
    path_set_shadow_origin(path, slot, origin);
    path_set_shadow_direction(path, slot, light.infinite ? to_light : light.target - origin);
    path_set_shadow_t_max(path, slot, light.infinite ? INFINITY : SHADOW_END);
    path_set_contribution(path, slot, contribution);
    return true;
}
#endif

// Samples the BSDF and stores the path's next ray; false where the path ends.
static inline bool sample_bsdf(const scene_t *scene, const path_t *path, uint slot, const BSDF(t) *bsdf, const vertex_t *vertex, float3 throughput)
{
    const uint lobe = random_lobe(&vertex->random);
    const pair_t u = random_bsdf(&vertex->random);
    bsdf_sample_t s = BSDF(sample)(bsdf, vertex->wo, (float3)(unit_float(lobe), unit_float(u.x), unit_float(u.y)));
    throughput *= s.weight;
    float3 direction = frame_to_world(&vertex->frame, s.wi);
    if (is_black(throughput) || !sides_agree(vertex, direction, s.wi))
        return false;
    float scale = 1.0f;
#ifdef PATH_ETA_SCALE
    // Roulette looks at the energy, without the 1/η² by which an interface scales radiance (PBR 4ed, §14.3.2).
    scale = path_get_eta_scale(path, slot) * s.eta * s.eta;
    path_set_eta_scale(path, slot, scale);
#endif
    if (vertex->depth + 1u >= scene->render->russian_roulette_depth) {
        float survival = fmin(1.0f, scale * max_component(fabs(throughput)));
        if (unit_float(random_roulette(&vertex->random)) >= survival)
            return false;
        throughput /= survival;
    }
    path_set_origin(path, slot, ray_origin(vertex, direction));
    path_set_direction(path, slot, normalize(direction));
    path_set_throughput(path, slot, throughput);
#ifdef RAY_CONES
    if (!s.specular)
        path_set_cone_spread(path, slot, cone_spread_after(path_get_cone_spread(path, slot), s.pdf));
#endif
    bool alone = s.specular;  // light sampling could not have found what lies there
#ifdef SUBSURFACE
    path_set_steps(path, slot, 0u);
#ifdef WALKS
    alone = cross_surface(path, slot, bsdf, vertex, &s) || alone;
#else
    alone = vertex->inside || alone;
#endif
#endif
#ifdef PATH_BSDF_PDF
    path_set_bsdf_pdf(path, slot, alone ? 0.0f : s.pdf);
#endif
    return true;
}

#ifdef PRIORITY
// Goes straight on through a boundary that another body hides: no scattering event. Light sampling cannot: the light met behind counts in full.
static inline void pass_boundary(const path_t *path, uint slot, const vertex_t *vertex, float3 direction, const interiors_t *crossed)
{
    path_set_origin(path, slot, ray_origin(vertex, direction));
#ifdef PATH_BSDF_PDF
    path_set_bsdf_pdf(path, slot, 0.0f);
#endif
    interiors_set(path, slot, crossed);
}
#endif

// Shades `slot`; says whether it wants connect, and whether the path goes on.
static inline void shade_slot(const scene_t *scene, const path_t *path, const samples_t *samples, uint slot, const vertex_random_t *random,
                              bool *connects, bool *goes_on)
{
    *connects = false;
    *goes_on = false;
    ray_t ray;
    ray.o = path_get_origin(path, slot);
    ray.d = path_get_direction(path, slot);
    ray.t_max = INFINITY;
    float3 t_u_v = path_get_hit(path, slot);
    hit_t hit;
    hit.t = t_u_v.x;
    hit.u = t_u_v.y;
    hit.v = t_u_v.z;
    hit.primitive = path_get_primitive(path, slot);

    vertex_t vertex;
    vertex.surface = surface_at(scene, &ray, &hit);
#ifdef RAY_CONES
    const float cone_width = path_get_cone_width(path, slot) + path_get_cone_spread(path, slot) * hit.t;
    path_set_cone_width(path, slot, cone_width);
    vertex.surface.footprint = cone_footprint(cone_width, dot(vertex.surface.ng, ray.d));
#endif
    vertex.depth = path_get_depth(path, slot);
    vertex.random = *random;
    vertex.sample = path_get_sample(path, slot);
    uint object_index = scene->primitive_objects[hit.primitive];
#ifdef MIXES
    global const object_t *object = scene->objects + path_get_object(path, slot);
#else
    global const object_t *object = scene->objects + object_index;
#endif
#ifdef NESTED
    const interiors_t interiors = interiors_get(path, slot);
    path_set_throughput(path, slot, path_get_throughput(path, slot) * interiors_transmittance(scene, &interiors, hit.t));
#endif
    add_emission(scene, path, samples, slot, hit.primitive, object, &vertex.surface, ray.d, vertex.depth);
#if !defined(FIRST_HIT_AOVS) && !defined(PRIORITY)
    if (vertex.depth >= scene->render->max_depth)
        return;
#endif
    float3 throughput = path_get_throughput(path, slot);
    BSDF(t) bsdf = BSDF(load)(scene, object->material, &vertex.surface);
    make_frame(scene, object, -ray.d, &vertex);
#ifdef PRIORITY
    interiors_t crossed = interiors;
    if (object->body != 0u) {
        if (!interiors_meet(scene, &interiors, object->body, vertex.wo.z > 0.0f, &crossed, &bsdf.ior)) {
            pass_boundary(path, slot, &vertex, ray.d, &crossed);
            *goes_on = true;
            return;
        }
        bsdf.transmittance = (float3)(1.0f);  // the path's segments are tinted above
    }
#endif
#ifdef SUBSURFACE
    vertex.inside = path_get_extinction(path, slot).x > 0.0f;
#ifdef WALKS
    bsdf.inside = vertex.inside && vertex.wo.z < 0.0f;
#endif
#endif
#ifdef ABSORPTION
    if (vertex.wo.z < 0.0f)
        throughput *= BSDF(absorption)(&bsdf, hit.t);  // the path has come from inside
#endif
#ifdef FIRST_HIT_AOVS
    if (vertex.depth == 0u)
        write_first_hit(scene, samples, vertex.sample, throughput.x, &vertex.surface, vertex.surface.ns, BSDF(albedo)(&bsdf), object_index);
#endif
#if defined(FIRST_HIT_AOVS) || defined(PRIORITY)
    if (vertex.depth >= scene->render->max_depth)
        return;
#endif
#ifdef VERTEX_NORMALS
    lift_point(object, &vertex);
#endif
#ifdef DISPERSION
    const sequence_t sampler = sequence_new(scene, path_get_seed(path, slot), path_get_index(path, slot));
    const float3 carried = fabs(throughput);
    const float sum = carried.x + carried.y + carried.z;
    bsdf.share = sum > 0.0f ? carried / sum : (float3)(1.0f / 3.0f);
    bsdf.spread = dispersion_spread(unit_float(sample_1d(&sampler, DIMENSION_WAVELENGTH)));
#endif
#ifdef NEXT_EVENT_ESTIMATION
    *connects = sample_light(scene, path, slot, &bsdf, &vertex, throughput);
#endif
    *goes_on = sample_bsdf(scene, path, slot, &bsdf, &vertex, throughput);
#ifdef PRIORITY
    if (*goes_on && object->body != 0u && frame_to_local(&vertex.frame, path_get_direction(path, slot)).z * vertex.wo.z < 0.0f)
        interiors_set(path, slot, &crossed);
#endif
    path_set_depth(path, slot, vertex.depth + 1u);
}

#ifdef NEXT_EVENT_ESTIMATION
#define PUSH(next, connects, slot) queue_push_with_connect(&queues, next, connects, slot, scratch)
#else
#define PUSH(next, connects, slot) queue_push(&queues, next, slot, scratch)
#endif

#ifdef VERTEX_LANES

// A work-item shades sixteen slots.
kernel LANES_GROUP UNVECTORIZED void shade(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    const uint first = (uint)get_global_id(0) * LANES;
    if (!any_lane(queue_holds_lanes(&queues, QUEUE_SHADE, first)))
        return;
    each_uint_t light_x, light_y, lobe, bsdf_x, bsdf_y, roulette;
    const vertex_numbers_t numbers = {&light_x, &light_y, &lobe, &bsdf_x, &bsdf_y, &roulette};
    vertex_numbers_draw(&scene, &path, first, &numbers);
    for (uint lane = 0u; lane < LANES; lane++) {
        if (!queue_holds(&queues, QUEUE_SHADE, first + lane))
            continue;
        const vertex_random_t random = {numbers, lane};
        bool connects, goes_on;
        shade_slot(&scene, &path, &samples, first + lane, &random, &connects, &goes_on);
        PUSH(goes_on ? QUEUE_EXTEND_0 : QUEUE_IDLE_0, connects, first + lane);
    }
}

#else

kernel WORK_GROUP UNVECTORIZED void shade(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    if (queue_is_over(&queues, QUEUE_SHADE))
        return;
    uint slot = queue_take(&queues, QUEUE_SHADE);
    bool connects = false, goes_on = false;
    uint next = NO_QUEUE;
    if (slot != NO_SLOT) {
        const vertex_random_t random = {sequence_new(&scene, path_get_seed(&path, slot), path_get_index(&path, slot)), path_get_depth(&path, slot)};
        shade_slot(&scene, &path, &samples, slot, &random, &connects, &goes_on);
        next = goes_on ? QUEUE_EXTEND_0 : QUEUE_IDLE_0;
#ifdef QUEUES_COMPACTED
        next += 1u - parity;
#endif
    }
    PUSH(next, connects, slot);
}

#endif
