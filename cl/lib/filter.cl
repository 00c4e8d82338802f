// A point of the pixel filter along one axis, in pixels, and its weight.

#include "lib/math.cl"

static inline float2 filter_sample(const scene_t *scene, float u)
{
#ifdef FILTER_TABLE
    // By a table of the inverse of its CDF (Ernst, Stamminger & Greiner 2006).
    float at = u * FILTER_TABLE_SIZE;
    uint step = min((uint)at, FILTER_TABLE_SIZE - 1u);
    global const float *entry = scene->filter_table + 2 * step;
    return (float2)(mix(entry[0], entry[2], at - (float)step), entry[1]);
#else
    return (float2)((2.0f * u - 1.0f) * scene->render->filter_radius, 1.0f);
#endif
}
