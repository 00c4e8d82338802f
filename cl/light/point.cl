// Point lights: intensity over the distance squared.

static inline light_sample_t point_sample(const scene_t *scene, uint index, float3 reference, uint2 u)
{
    global const point_light_t *light = scene->point_lights + index;
    float3 position = load3(light->position), w = position - reference;
    return light_sample_new(position, load3(light->intensity) / dot(w, w), 1.0f, 0, 1);
}
