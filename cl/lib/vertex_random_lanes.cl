// The random numbers of a path's vertex: those of sixteen neighbouring slots are drawn beforehand, in vectors.

#include "lib/lanes.cl"
#include "lib/path.cl"
#include "lib/sampler.cl"
#include "scene/sampler_lanes.cl"

// Each in a variable of its own, so that a kind of BSDF that has no use for one doesn't draw it.
typedef struct {
    each_uint_t *light_x, *light_y, *lobe, *bsdf_x, *bsdf_y, *roulette;
} vertex_numbers_t;

// A vertex's numbers: a lane of those of its neighbours.
typedef struct {
    vertex_numbers_t numbers;
    uint lane;
} vertex_random_t;

static inline void vertex_numbers_draw(const scene_t *scene, const path_t *path, uint first, const vertex_numbers_t *numbers)
{
    const sequence_t_lanes sampler = {path_get_seed_lanes(path, first), path_get_index_lanes(path, first)};
    const uint16 depth = path_get_depth_lanes(path, first), dimension = (depth + 1u) * DIMENSIONS_A_VERTEX;
    const pair_t_lanes light = sample_2d_lanes(&sampler, dimension + DIMENSION_LIGHT), bsdf = sample_2d_lanes(&sampler, dimension + DIMENSION_BSDF);
    numbers->light_x->all = light.x;
    numbers->light_y->all = light.y;
    numbers->lobe->all = sample_1d_lanes(&sampler, dimension + DIMENSION_LOBE);
    numbers->bsdf_x->all = bsdf.x;
    numbers->bsdf_y->all = bsdf.y;
    if (any_lane(depth + 1u >= scene->render->russian_roulette_depth))
        numbers->roulette->all = sample_1d_lanes(&sampler, dimension + DIMENSION_ROULETTE);
}

static inline pair_t random_light(const vertex_random_t *random)
{
    const pair_t pair = {random->numbers.light_x->lane[random->lane], random->numbers.light_y->lane[random->lane]};
    return pair;
}

static inline uint random_lobe(const vertex_random_t *random)
{
    return random->numbers.lobe->lane[random->lane];
}

static inline pair_t random_bsdf(const vertex_random_t *random)
{
    const pair_t pair = {random->numbers.bsdf_x->lane[random->lane], random->numbers.bsdf_y->lane[random->lane]};
    return pair;
}

static inline uint random_roulette(const vertex_random_t *random)
{
    return random->numbers.roulette->lane[random->lane];
}
