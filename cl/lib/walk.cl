// The random walk of a path in a body: its medium is carried with the path from where it entered to where it leaves.

#include "lib/medium.cl"
#include "lib/path.cl"
#include "lib/sampler.cl"

#ifdef SUBSURFACE
// A walk is exact for so many events. What has not come back by then is deep in a large body, where light diffuses: from there on steps grow,
// doubled after each WALK_DOUBLING events, in a medium that diffuses light alike (medium_similar).
#define WALK_EXACT 256u
#define WALK_DOUBLING 128u
// After so many a walk goes straight on to the surface, as if nothing scattered: white bodies lose no light.
#define WALK_STEPS 1024u

// The next flight of a path. `inside`: it is in a body.
typedef struct {
    medium_t medium;
    float3 chances;
    bool inside;
    bool straight;
} flight_t;

static inline flight_t flight_of(const path_t *path, uint slot)
{
    flight_t flight;
    flight.medium.extinction = path_get_extinction(path, slot);
    flight.medium.albedo = path_get_scattering_albedo(path, slot);
    flight.medium.g = path_get_asymmetry(path, slot);
    flight.chances = channel_chances(path_get_throughput(path, slot));
    flight.inside = flight.medium.extinction.x > 0.0f;
    const uint steps = path_get_steps(path, slot);
    if (flight.inside && steps > WALK_EXACT)
        flight.medium = medium_similar(flight.medium, exp2((float)(steps - WALK_EXACT) * (1.0f / WALK_DOUBLING)));
    flight.straight = steps >= WALK_STEPS;
    return flight;
}

// The random numbers of a walk's step: a pixel's seed of its own.
static inline uint step_seed(const path_t *path, uint slot)
{
    const uint seed = path_get_seed(path, slot), steps = path_get_steps(path, slot);
    return steps > 0u ? hash_combine(seed, steps) : seed;
}

static inline sequence_t step_sequence(const scene_t *scene, const path_t *path, uint slot)
{
    return sequence_new(scene, step_seed(path, slot), path_get_index(path, slot));
}

// How far the path goes if no surface is in its way.
static inline float flight_end(const scene_t *scene, const path_t *path, uint slot, const flight_t *flight)
{
    if (!flight->inside || flight->straight)
        return INFINITY;
    const sequence_t sampler = step_sequence(scene, path, slot);
    const pair_t u = sample_2d(&sampler, vertex_dimension(path_get_depth(path, slot), DIMENSION_FLIGHT));
    return flight_distance(&flight->medium, flight->chances, (float2)(unit_float(u.x), unit_float(u.y)));
}

// Weighs the path that has flown `distance`, to a surface or out of the scene.
static inline void flight_pass(const path_t *path, uint slot, const flight_t *flight, float distance)
{
    if (!flight->inside)
        return;
    const float3 weight = flight->straight ? unscattered(&flight->medium, distance) : passage_weight(&flight->medium, flight->chances, distance);
    path_set_throughput(path, slot, path_get_throughput(path, slot) * weight);
}
#endif
