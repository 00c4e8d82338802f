// Spot lights: a point light inside a cone, fading smoothly (3t² − 2t³ in the cosine; PBR 4ed, §12.2.1).

static inline light_sample_t spot_sample(const scene_t *scene, uint index, float3 reference, uint2 u)
{
    global const spot_light_t *light = scene->spot_lights + index;
    float3 position = load3(light->position), w = position - reference;
    float distance2 = dot(w, w);
    float cosine = -dot(w, load3(light->axis)) * rsqrt(distance2);
    float width = light->cos_inner - light->cos_outer;
    float t = width > 0.0f ? clamp((cosine - light->cos_outer) / width, 0.0f, 1.0f) : (cosine >= light->cos_outer ? 1.0f : 0.0f);
    float falloff = t * t * (3.0f - 2.0f * t);
    return light_sample_new(position, load3(light->intensity) * (falloff / distance2), falloff > 0.0f ? 1.0f : 0.0f, 0, 1);
}
