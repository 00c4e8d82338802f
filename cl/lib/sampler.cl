// Random numbers as a function of (seed, pixel, index of the sample, dimension).

#include "lib/dimensions.cl"
#include "lib/hash.cl"
#include "lib/sequence.cl"
#include "scene/sampler.cl"

static inline uint vertex_dimension(uint depth, uint which)
{
    return (depth + 1u) * DIMENSIONS_A_VERTEX + which;
}

// The pixel and the sample of it that a place in the batch stands for: a pixel's samples lie side by side, pixels in tiles of 8 × 8.
typedef struct {
    uint x;      // in the whole picture
    uint y;
    uint index;  // of the sample
} film_sample_t;

static inline film_sample_t film_sample(const scene_t *scene, uint sample)
{
    global const render_t *render = scene->render;
#ifdef PIXEL_LIST
    uint2 entry = scene->pixel_list[sample / scene->batch->samples_a_pixel];
    uint ordinal = entry.x, first_sample = entry.y;
#else
    uint ordinal = scene->batch->first_pixel + sample / scene->batch->samples_a_pixel, first_sample = scene->batch->first_sample;
#endif
    uint width = render->crop_width, height = render->crop_height;
    uint band = ordinal / (8u * width);
    uint band_height = min(8u, height - 8u * band);
    uint in_band = ordinal - 8u * band * width;
    uint tile = in_band / (8u * band_height);
    uint tile_width = min(8u, width - 8u * tile);
    uint in_tile = in_band - 8u * tile * band_height;
    film_sample_t s;
    s.x = render->crop_x + 8u * tile + in_tile % tile_width;
    s.y = render->crop_y + 8u * band + in_tile / tile_width;
    s.index = first_sample + sample % scene->batch->samples_a_pixel;
    return s;
}

// The random numbers of a sample: its pixel's seed, its index.
static inline sequence_t sequence_new(const scene_t *scene, uint seed, uint index)
{
    sequence_t sequence;
    sequence.seed = seed;
    sequence.index = index;
#ifdef SAMPLER_STRATA
    sequence.strata_x = scene->render->strata_x;
    sequence.strata_y = scene->render->strata_y;
#endif
    return sequence;
}

static inline uint pixel_seed(const scene_t *scene, film_sample_t at)
{
    return hash_combine(hash_combine(scene->render->seed, at.x), at.y);
}

// A number for each ray of a path, from which each surface it meets takes its own random number (accel/counts.cl).
static inline uint ray_seed(uint pixel, uint index, uint ray)
{
    return hash_combine(hash_combine(pixel, index), ray);
}
