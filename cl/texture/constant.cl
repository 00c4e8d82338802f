// One value everywhere.

static inline float3 constant_texture(const scene_t *scene, uint index, const surface_t *surface)
{
    return load3(scene->constant_textures[index].value);
}
