// A checkerboard: a where the sum of the cell's two indices is even.

static inline float3 checker_texture(const scene_t *scene, uint index, const surface_t *surface)
{
    global const checker_texture_t *checker = scene->checker_textures + index;
    float2 cell = floor(surface->uv * (float2)(checker->scale[0], checker->scale[1]));
    float sum = cell.x + cell.y;
    return sum - 2.0f * floor(0.5f * sum) == 0.0f ? load3(checker->a) : load3(checker->b);
}
