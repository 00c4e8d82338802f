// connect: traces shadow rays, and adds what each carries where nothing is in its way. Exists only where a light is sampled.
//
// From: shade. To: nothing; the sample buffer.

#include "accel/visits.cl"
#include "lib/path.cl"
#include "lib/queue.cl"
#include "lib/sampler.cl"
#include "lib/samples.cl"
#include "lib/shapes.cl"

kernel WORK_GROUP UNVECTORIZED void connect(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    uint slot = queue_take_connect(&queues);
    if (slot == NO_SLOT)
        return;
    ray_t ray;
    ray.o = path_get_shadow_origin(&path, slot);
    ray.d = path_get_shadow_direction(&path, slot);
    ray.t_max = path_get_shadow_t_max(&path, slot);
#ifdef VISIBILITY
    scene.ray_mask = OBJECT_VISIBLE_TO_SHADOW;
#endif
#ifdef OPACITY
    scene.ray_seed = ray_seed(path_get_seed(&path, slot), path_get_index(&path, slot), 2u * path_get_depth(&path, slot) + 1u);
#endif
    bool occluded = trace_occluded(&scene, &ray);
    RECORD_VISITS(slot, 1u);
    if (!occluded)
        sample_add_radiance(&scene, &samples, path_get_sample(&path, slot), path_get_depth(&path, slot), path_get_contribution(&path, slot));
}
