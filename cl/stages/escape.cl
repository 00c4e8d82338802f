// escape: adds what infinite lights send along the rays that leave the scene. Exists only where the scene has such lights.
//
// From: extend. To: the slot is idle.

#include "lib/lights.cl"
#include "lib/path.cl"
#include "lib/queue.cl"
#include "lib/samples.cl"

kernel WORK_GROUP UNVECTORIZED void escape(STAGE_PARAMETERS)
{
    STAGE_BEGIN
    if (queue_is_over(&queues, QUEUE_ESCAPE))
        return;
    uint slot = queue_take(&queues, QUEUE_ESCAPE);
    uint next = NO_QUEUE;
    if (slot != NO_SLOT) {
        float3 w = path_get_direction(&path, slot);
        float3 radiance = (float3)(0.0f);
#ifdef PATH_BSDF_PDF
        float bsdf_pdf = path_get_bsdf_pdf(&path, slot);
#else
        float bsdf_pdf = 0.0f;
#endif
#define ADD_INFINITE(NAME) \
        for (uint i = 0u; i < scene.render->NAME##_light_count; ++i) { \
            float3 from_light = NAME##_radiance(&scene, i, w); \
            if (!is_black(from_light)) { \
                float choice = discrete_probability(scene.light_cdf, scene.render->NAME##_light_first + i); \
                radiance += from_light * met_light_weight(bsdf_pdf, choice * NAME##_pdf(&scene, i, w)); \
            } \
        }
        FOR_EACH_INFINITE_LIGHT(ADD_INFINITE)
        sample_add_radiance(&scene, &samples, path_get_sample(&path, slot), path_get_depth(&path, slot),
                            path_get_throughput(&path, slot) * radiance);
        next = QUEUE_IDLE_0;
#ifdef QUEUES_COMPACTED
        next += 1u - parity;
#endif
    }
    queue_push(&queues, next, slot, scratch);
}
