// Pictures. Texel (0, 0) is the bottom left, its centre at uv (½, ½) / size; bilinear between centres.

#define TEXEL_SRGB8 0
#define TEXEL_LINEAR8 1
#define TEXEL_FLOAT 2
#define WRAP_REPEAT 0
#define WRAP_CLAMP 1

// IEC 61966-2-1:1999.
static inline float srgb_to_linear(float x)
{
    return x <= 0.04045f ? x / 12.92f : pow((x + 0.055f) / 1.055f, 2.4f);
}

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

static inline float4 image_texel(const scene_t *scene, global const image_texture_t *image, int x, int y)
{
    x = image_wrap(x, image->width, image->wrap);
    y = image_wrap(y, image->height, image->wrap);
    size_t texel = (size_t)y * (size_t)image->width + (size_t)x;
    if (image->format == TEXEL_FLOAT) {
        global const uint *words = scene->texels + image->first + 4 * texel;
        return (float4)(as_float(words[0]), as_float(words[1]), as_float(words[2]), as_float(words[3]));
    }
    uint word = scene->texels[image->first + texel];
    float4 value = (float4)(word & 255u, (word >> 8) & 255u, (word >> 16) & 255u, word >> 24) / 255.0f;
    if (image->format == TEXEL_SRGB8)
        value.xyz = (float3)(srgb_to_linear(value.x), srgb_to_linear(value.y), srgb_to_linear(value.z));
    return value;
}

static inline float3 image_texture(const scene_t *scene, uint index, const surface_t *surface)
{
    global const image_texture_t *image = scene->image_textures + index;
    float2 size = (float2)(image->width, image->height);
    float2 at = surface->uv * (float2)(image->scale[0], image->scale[1]) + (float2)(image->offset[0], image->offset[1]);
    if (image->wrap == WRAP_REPEAT)
        at -= floor(at);  // so that far-out uv stay exact enough for an int
    at = clamp(at * size, -1e9f, 1e9f);
    float4 value;
    if (image->nearest) {
        value = image_texel(scene, image, (int)floor(at.x), (int)floor(at.y));
    } else {
        at -= 0.5f;
        float2 low = floor(at), f = at - low;
        int x = (int)low.x, y = (int)low.y;
        value = (1.0f - f.y) * ((1.0f - f.x) * image_texel(scene, image, x, y) + f.x * image_texel(scene, image, x + 1, y))
              + f.y * ((1.0f - f.x) * image_texel(scene, image, x, y + 1) + f.x * image_texel(scene, image, x + 1, y + 1));
    }
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
