// Choosing and sampling a light. Lights are numbered: emitting primitives first, then kind after kind. scene->light_cdf says how likely each is chosen.

#include "lib/discrete.cl"
#include "lib/frame.cl"
#include "lib/light_sample.cl"
#include "lib/math.cl"
#include "lib/mis.cl"
#include "scene/lights.cl"

// Where a shadow ray to a point ends, short of the light's own surface (PBR 4ed, §6.8.6): a blocker nearer to it than 1e-4 of the way is missed.
#define SHADOW_END 0.9999f

// A light by u.x, then a direction or point of it by what the choice leaves of u.x, and by u.y: so the lights together are stratified in two dimensions.
// (On a light of probability p that leaves steps of 2⁻³² / p.) The pdf includes the choice.
static inline light_sample_t light_sample(const scene_t *scene, float3 reference, uint2 u)
{
    discrete_t chosen = discrete_sample(scene->light_cdf, scene->render->light_count, u.x);
    u.x = chosen.rest;
    light_sample_t s = light_sample_new(reference, (float3)(0.0f), 0.0f, 0, 0);
#ifdef EMITTERS
    if (chosen.index < scene->render->emitter_count)
        s = emitter_sample(scene, chosen.index, reference, u);
#endif
#define SAMPLE_LIGHT(NAME) \
    if (chosen.index - scene->render->NAME##_light_first < scene->render->NAME##_light_count) \
        s = NAME##_sample(scene, chosen.index - scene->render->NAME##_light_first, reference, u);
    FOR_EACH_LIGHT(SAMPLE_LIGHT)
    s.pdf *= chosen.probability;
    return s;
}
