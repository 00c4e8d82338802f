// Directional lights without an angle.

static inline light_sample_t directional_sample(const scene_t *scene, uint index, float3 reference, uint2 u)
{
    global const directional_light_t *light = scene->directional_lights + index;
    return light_sample_new(-load3(light->direction), load3(light->radiance), 1.0f, 1, 1);
}
