// shade, for sixteen neighbouring slots at once: the same steps as in stages/shade.cl, in vectors. Takes its place on CPUs, for kinds of BSDF that are
// written for lanes, in scenes that have nothing that is not (lumiere/wavefront/lanes.py).
//
// From: extend. To: connect (a shadow ray), extend (the path goes on); else the slot is idle.

#include "lib/lanes.cl"
#include "lib/lights_lanes.cl"
#include "lib/met_emission.cl"
#include "lib/path.cl"
#include "lib/queue.cl"
#include "lib/vertex_random_lanes.cl"
#include "scene/bsdf_lanes.cl"
#include "scene/surfaces_met.cl"

// Where the paths stand, lane by lane; in lanes of slots that want something else, on the first primitive.
typedef struct {
    each_uint_t primitive;
    each_int_t two_sided;
    each_uint_t material;
    each_int_t emits;
} met_t;

typedef struct {
    surface_t_lanes surface;
    frame_t_lanes frame;  // of the true surface: there are no vertex normals, so its sides are those of the frame
    float3_lanes wo;      // local, towards where the path came from
    uint16 depth;         // scattering events before this one
    float3_lanes throughput;
} vertices_t;

static inline met_t what_was_met(const scene_t *scene, const path_t *path, int16 waiting, uint first)
{
    const each_int_t wanted = {waiting};
    met_t met;
    met.primitive.all = waiting ? path_get_primitive_lanes(path, first) : 0u;
    ONE_BY_ONE
    for (uint lane = 0u; lane < LANES; lane++) {
        global const object_t *object = scene->objects + scene->primitive_objects[met.primitive.lane[lane]];
        met.two_sided.lane[lane] = (object->flags & OBJECT_TWO_SIDED) != 0u ? -1 : 0;
        met.material.lane[lane] = wanted.lane[lane] ? object->material : 0u;
#ifdef EMISSION
        met.emits.lane[lane] = object->emission >= 0 ? -1 : 0;
#endif
    }
    return met;
}

#ifdef EMISSION
static inline void add_emissions(const scene_t *scene, const path_t *path, const samples_t *samples, uint first, int16 waiting, const met_t *met,
                                 const surface_t_lanes *surface, float3_lanes direction, uint16 depths)
{
    const each_int_t emits = {waiting & met->emits.all};
    if (!any_lane(emits.all))
        return;
    const each_uint_t depth = {depths};
    for (uint lane = 0u; lane < LANES; lane++) {
        if (!emits.lane[lane])
            continue;
        const uint primitive = met->primitive.lane[lane];
        const surface_t at = surface_new(lane_of(&surface->p, lane), lane_of(&surface->error, lane), lane_of(&surface->ng, lane));
        add_emission(scene, path, samples, first + lane, primitive, scene->objects + scene->primitive_objects[primitive], &at,
                     lane_of(&direction, lane), depth.lane[lane]);
    }
}
#endif

static inline float3_lanes ray_origins(const vertices_t *v, float3_lanes w)
{
    return offset_origin_lanes(v->surface.p, v->surface.error, v->surface.ng, w);
}

#ifdef NEXT_EVENT_ESTIMATION
// Samples a light for each path that is `waiting`, and stores the shadow rays that connect to them; says where something can come of it.
static inline int16 sample_lights(const scene_t *scene, const path_t *path, uint first, int16 waiting, const BSDF(t_lanes) *bsdf, const vertices_t *v,
                                  pair_t_lanes u)
{
    const light_sample_t_lanes light = light_sample_lanes(scene, waiting, v->surface.p, u);
    const float3_lanes to_point = subtract3_lanes(light.target, v->surface.p);
    const float3_lanes to_light = select_lanes(light.infinite, light.target, unit3_lanes(to_point));
    const float3_lanes wi = frame_to_local_lanes(&v->frame, to_light);
    const float16 bsdf_pdf = BSDF(pdf_lanes)(bsdf, v->wo, wi);
    const float16 weight = sampled_light_weight_lanes(&light, bsdf_pdf) / light.pdf;
    const float3_lanes f = BSDF(eval_lanes)(bsdf, v->wo, wi);
    const float3_lanes contribution = scale3_lanes(multiply3_lanes(multiply3_lanes(v->throughput, f), light.radiance), weight);
    const int16 connects = waiting & (light.pdf > 0.0f) & ~is_black_lanes(contribution);
    const float3_lanes origin = ray_origins(v, to_light);
    path_set_shadow_origin_lanes(path, first, connects, origin);
    path_set_shadow_direction_lanes(path, first, connects, select_lanes(light.infinite, to_light, subtract3_lanes(light.target, origin)));
    path_set_shadow_t_max_lanes(path, first, connects, light.infinite ? INFINITY : SHADOW_END);
    path_set_contribution_lanes(path, first, connects, contribution);
#ifdef TRACED
    path_set_light_pdf_lanes(path, first, connects, light.pdf);
    path_set_light_bsdf_pdf_lanes(path, first, connects, bsdf_pdf);
#endif
    return connects;
}
#endif

// Samples the BSDF of each path that is `waiting`, and stores their next rays; says which go on.
static inline int16 sample_bsdfs(const scene_t *scene, const path_t *path, uint first, int16 waiting, const BSDF(t_lanes) *bsdf, const vertices_t *v,
                                 const vertex_numbers_t *numbers)
{
    const float3_lanes u = {unit_float_lanes(numbers->lobe->all), unit_float_lanes(numbers->bsdf_x->all), unit_float_lanes(numbers->bsdf_y->all)};
    const bsdf_sample_t_lanes s = BSDF(sample_lanes)(bsdf, v->wo, u);
    float3_lanes throughput = multiply3_lanes(v->throughput, s.weight);
    const float3_lanes direction = frame_to_world_lanes(&v->frame, s.wi);
    int16 goes_on = waiting & ~is_black_lanes(throughput);
    float16 scale = 1.0f;
#ifdef PATH_ETA_SCALE
    // Roulette looks at the energy, without the 1/η² by which an interface scales radiance (PBR 4ed, §14.3.2).
    scale = path_get_eta_scale_lanes(path, first) * s.eta * s.eta;
    path_set_eta_scale_lanes(path, first, goes_on, scale);
#endif
    const int16 gambles = goes_on & (v->depth + 1u >= scene->render->russian_roulette_depth);
    if (any_lane(gambles)) {
        const float3_lanes size = absolute3_lanes(throughput);
        const float16 largest = scale * larger_lanes(size.x, larger_lanes(size.y, size.z)), survival = (gambles & (largest < 1.0f)) ? largest : 1.0f;
        goes_on &= ~(gambles & (unit_float_lanes(numbers->roulette->all) >= survival));
        throughput = scale3_lanes(throughput, 1.0f / survival);
    }
    path_set_origin_lanes(path, first, goes_on, ray_origins(v, direction));
    path_set_direction_lanes(path, first, goes_on, unit3_lanes(direction));
    path_set_throughput_lanes(path, first, goes_on, throughput);
#ifdef PATH_BSDF_PDF
    path_set_bsdf_pdf_lanes(path, first, goes_on, s.specular ? 0.0f : s.pdf);
#endif
    return goes_on;
}

kernel LANES_GROUP UNVECTORIZED void shade(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    const uint first = (uint)get_global_id(0) * LANES;
    int16 waiting = queue_holds_lanes(&queues, QUEUE_SHADE, first);
    if (!any_lane(waiting))
        return;
    const int16 taken = waiting;
    each_uint_t light_x, light_y, lobe, bsdf_x, bsdf_y, roulette;
    const vertex_numbers_t numbers = {&light_x, &light_y, &lobe, &bsdf_x, &bsdf_y, &roulette};
    vertex_numbers_draw(&scene, &path, first, &numbers);

    const met_t met = what_was_met(&scene, &path, waiting, first);
    const float3_lanes direction = path_get_direction_lanes(&path, first);
    vertices_t v;
    v.surface = surfaces_met(&scene, &path, first, waiting, &met.primitive);
    v.depth = path_get_depth_lanes(&path, first);
    v.throughput = path_get_throughput_lanes(&path, first);
#ifdef EMISSION
    add_emissions(&scene, &path, &samples, first, waiting, &met, &v.surface, direction, v.depth);
#endif
    waiting &= v.depth < scene.render->max_depth;
    const BSDF(t_lanes) bsdf = BSDF(load_lanes)(&scene, &met.material);
    const float3_lanes to_viewer = scale3_lanes(direction, -1.0f);
    const int16 turned = met.two_sided.all & (dot3_lanes(to_viewer, v.surface.ng) < 0.0f);
    v.surface.ng = scale3_lanes(v.surface.ng, turned ? -1.0f : 1.0f);
    v.frame = frame_about_lanes(v.surface.ng);
    v.wo = frame_to_local_lanes(&v.frame, to_viewer);
#ifdef NEXT_EVENT_ESTIMATION
    const pair_t_lanes light = {light_x.all, light_y.all};
    queue_push_connect_lanes(&queues, sample_lights(&scene, &path, first, waiting, &bsdf, &v, light), first);
#endif
    const int16 goes_on = sample_bsdfs(&scene, &path, first, waiting, &bsdf, &v, &numbers);
    path_set_depth_lanes(&path, first, waiting, v.depth + 1u);
    queue_push_lanes(&queues, taken, goes_on ? (uint16)(QUEUE_EXTEND_0) : (uint16)(QUEUE_IDLE_0), first);
}
