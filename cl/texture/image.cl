// Pictures. Texel (0, 0) is the bottom left, its centre at uv (½, ½) / size; bilinear between centres.
// With the filter `mipmap` smaller and smaller pictures follow one another (Williams 1983, "Pyramidal Parametrics"; lumiere/texture/pyramid.py).

#define TEXEL_SRGB8 0
#define TEXEL_LINEAR8 1
#define TEXEL_FLOAT 2
#define WRAP_REPEAT 0
#define WRAP_CLAMP 1
#define FILTER_NEAREST 1
#define FILTER_MIPMAP 2

typedef struct {
    uint first;  // word of the texels
    int width;
    int height;
} image_level_t;

static inline int image_wrap(int i, int size, int wrap)
{
    if (wrap == WRAP_CLAMP)
        return clamp(i, 0, size - 1);
    if (wrap == WRAP_REPEAT) {
        i %= size;
        return i < 0 ? i + size : i;
    }
    int period = 2 * size;
    i %= period;
    i = i < 0 ? i + period : i;
    return i < size ? i : period - 1 - i;
}

static inline float4 image_texel(const scene_t *scene, global const image_texture_t *image, const image_level_t *level, int x, int y)
{
    x = image_wrap(x, level->width, image->wrap);
    y = image_wrap(y, level->height, image->wrap);
    size_t texel = (size_t)y * (size_t)level->width + (size_t)x;
    if (image->format == TEXEL_FLOAT) {
        global const uint *words = scene->texels + level->first + 4 * texel;
        return (float4)(as_float(words[0]), as_float(words[1]), as_float(words[2]), as_float(words[3]));
    }
    uint word = scene->texels[level->first + texel];
    if (image->format == TEXEL_SRGB8) {
        global const float *linear_values = scene->srgb_values;  // a table: powers would take most of a lookup's time
        return (float4)(linear_values[word & 255u], linear_values[(word >> 8) & 255u], linear_values[(word >> 16) & 255u], (word >> 24) / 255.0f);
    }
    return (float4)(word & 255u, (word >> 8) & 255u, (word >> 16) & 255u, word >> 24) / 255.0f;
}

static inline float4 image_bilinear(const scene_t *scene, global const image_texture_t *image, const image_level_t *level, float2 at)
{
    at = clamp(at * (float2)(level->width, level->height), -1e9f, 1e9f) - 0.5f;
    float2 low = floor(at), f = at - low;
    int x = (int)low.x, y = (int)low.y;
    return (1.0f - f.y) * ((1.0f - f.x) * image_texel(scene, image, level, x, y) + f.x * image_texel(scene, image, level, x + 1, y))
         + f.y * ((1.0f - f.x) * image_texel(scene, image, level, x, y + 1) + f.x * image_texel(scene, image, level, x + 1, y + 1));
}

#ifdef RAY_CONES
// The next smaller picture.
static inline image_level_t image_smaller(global const image_texture_t *image, image_level_t level)
{
    const uint words = (uint)level.width * (uint)level.height * (image->format == TEXEL_FLOAT ? 4u : 1u);
    const image_level_t next = {level.first + words, max(1, level.width / 2), max(1, level.height / 2)};
    return next;
}

// Between the two pictures whose texels are next in size to the ray's footprint (Akenine-Möller et al. 2021, eq. 2, of areas).
static inline float4 image_trilinear(const scene_t *scene, global const image_texture_t *image, image_level_t level, float2 at, const surface_t *surface)
{
    const float uv_area = length(cross(surface->dpdu, surface->dpdv));  // surface for a unit of u and v
    const float texels = fabs(image->scale[0] * image->scale[1]) * (float)level.width * (float)level.height * surface->footprint;
    float fine = texels > uv_area && uv_area > 0.0f ? 0.5f * log2(texels / uv_area) : 0.0f;
    while (fine >= 1.0f && max(level.width, level.height) > 1) {
        level = image_smaller(image, level);
        fine -= 1.0f;
    }
    const float4 value = image_bilinear(scene, image, &level, at);
    if (fine <= 0.0f || max(level.width, level.height) == 1)
        return value;
    level = image_smaller(image, level);
    return mix(value, image_bilinear(scene, image, &level, at), fine);
}
#endif

static inline float3 image_texture(const scene_t *scene, uint index, const surface_t *surface)
{
    global const image_texture_t *image = scene->image_textures + index;
    const image_level_t level = {image->first, image->width, image->height};
    float2 at = surface->uv * (float2)(image->scale[0], image->scale[1]) + (float2)(image->offset[0], image->offset[1]);
    if (image->wrap == WRAP_REPEAT)
        at -= floor(at);  // so that far-out uv stay exact enough for an int
    float4 value;
    if (image->filter == FILTER_NEAREST) {
        at = clamp(at * (float2)(level.width, level.height), -1e9f, 1e9f);
        value = image_texel(scene, image, &level, (int)floor(at.x), (int)floor(at.y));
    }
#ifdef RAY_CONES
    else if (image->filter == FILTER_MIPMAP)
        value = image_trilinear(scene, image, level, at, surface);
#endif
    else
        value = image_bilinear(scene, image, &level, at);
    float3 factor = load3(image->factor);
    switch (image->channel) {
    case 0:
        return factor * value.x;
    case 1:
        return factor * value.y;
    case 2:
        return factor * value.z;
    case 3:
        return factor * value.w;
    default:
        return factor * value.xyz;
    }
}
