// The colours of a mesh's vertices.

static inline float3 vertex_color_texture(const scene_t *scene, uint index, const surface_t *surface)
{
    return surface->color;
}
