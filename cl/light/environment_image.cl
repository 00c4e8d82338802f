// The environment as a lat-long picture: the centre column is −Z, columns run to the viewer's right, row 0 is +Y.
// Looked up bilinearly; sampled by texel, then uniformly in the texel's angles (PBR 4ed, §12.5).

#include "lib/discrete.cl"

static inline float3 environment_texel(const scene_t *scene, int width, int x, int y)
{
    return load3(scene->environment_texels + 3 * ((size_t)y * (size_t)width + (size_t)x));
}

static inline float2 environment_uv(global const environment_image_light_t *light, float3 w)
{
    float3 d = rotate3(&light->to_local[0], w);
    return (float2)(0.5f + atan2(d.x, -d.z) * INV_TWO_PI, atan2(hypot(d.x, d.z), d.y) * INV_PI);
}

static inline float3 environment_image_lookup(const scene_t *scene, global const environment_image_light_t *light, float2 uv)
{
    int width = light->width, height = light->height;
    float x = uv.x * (float)width - 0.5f, y = uv.y * (float)height - 0.5f;
    float x_low = floor(x), y_low = floor(y);
    float fx = x - x_low, fy = y - y_low;
    int x0 = (int)x_low, y0 = clamp((int)y_low, 0, height - 1), y1 = clamp((int)y_low + 1, 0, height - 1);
    x0 = x0 < 0 ? x0 + width : min(x0, width - 1);
    int x1 = x0 + 1 < width ? x0 + 1 : 0;
    return load3(light->radiance)
         * ((1.0f - fy) * ((1.0f - fx) * environment_texel(scene, width, x0, y0) + fx * environment_texel(scene, width, x1, y0))
            + fy * ((1.0f - fx) * environment_texel(scene, width, x0, y1) + fx * environment_texel(scene, width, x1, y1)));
}

// Density over the sphere of a texel drawn with `probability`: over its angles, 2π/w × π/h, each of solid angle sin θ.
static inline float environment_image_density(global const environment_image_light_t *light, float probability, float sine)
{
    return sine > 0.0f ? probability * (float)light->width * (float)light->height / (2.0f * PI * PI * sine) : 0.0f;
}

static inline light_sample_t environment_image_sample(const scene_t *scene, uint index, float3 reference, uint2 u)
{
    global const environment_image_light_t *light = scene->environment_image_lights + index;
    discrete_t row = discrete_sample(scene->environment_rows, (uint)light->height, u.y);
    discrete_t column = discrete_sample(scene->environment_columns + (size_t)row.index * (size_t)light->width, (uint)light->width, u.x);
    float2 uv = (float2)(((float)column.index + unit_float(column.rest)) / (float)light->width,
                         ((float)row.index + unit_float(row.rest)) / (float)light->height);
    float phi = 2.0f * PI * (uv.x - 0.5f), theta = PI * uv.y, sine = sin(theta);
    float3 w = rotate3_back(&light->to_local[0], (float3)(sine * sin(phi), cos(theta), -sine * cos(phi)));
    float pdf = environment_image_density(light, row.probability * column.probability, sine);
    return light_sample_new(w, environment_image_lookup(scene, light, uv), pdf, 1, 0);
}

static inline float environment_image_pdf(const scene_t *scene, uint index, float3 w)
{
    global const environment_image_light_t *light = scene->environment_image_lights + index;
    float2 uv = environment_uv(light, w);
    uint row = (uint)clamp((int)(uv.y * (float)light->height), 0, light->height - 1);
    uint column = (uint)clamp((int)(uv.x * (float)light->width), 0, light->width - 1);
    float probability = discrete_probability(scene->environment_rows, row)
                      * discrete_probability(scene->environment_columns + (size_t)row * (size_t)light->width, column);
    return environment_image_density(light, probability, sin(PI * uv.y));
}

static inline float3 environment_image_radiance(const scene_t *scene, uint index, float3 w)
{
    global const environment_image_light_t *light = scene->environment_image_lights + index;
    return environment_image_lookup(scene, light, environment_uv(light, w));
}
