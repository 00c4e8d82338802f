// Boxes to primitives, and the root's bounds. One work-item takes `span` of them.

#include "accel/build/tree.cl"

static inline void boxes_take(float8 box, uint i, global float8 *primitives, float8 *joined, float8 *centres)
{
    primitives[i] = box;
    *joined = box_join(*joined, box);
    *centres = box_join(*centres, box_centre(box));
}

KERNEL void boxes(global const float *lower, global const float *upper, const uint count, const uint span, global float8 *primitives,
                  global uint *bounds)
{
    uint begin = (uint)get_global_id(0) * span;
    if (begin >= count)
        return;
    float8 joined = box_nothing(), centres = box_nothing();
    for (uint i = begin; i < begin + min(span, count - begin); i++)
        boxes_take(primitive(vload3(i, lower), vload3(i, upper), i), i, primitives, &joined, &centres);
    box_join_keys(bounds, joined);
    box_join_keys(bounds + 6, centres);
}

KERNEL void triangle_boxes(global const float *vertices, const uint count, const uint span, global float8 *primitives, global uint *bounds)
{
    uint begin = (uint)get_global_id(0) * span;
    if (begin >= count)
        return;
    float8 joined = box_nothing(), centres = box_nothing();
    for (uint i = begin; i < begin + min(span, count - begin); i++) {
        float3 a = vload3(3u * (size_t)i, vertices), b = vload3(3u * (size_t)i + 1u, vertices), c = vload3(3u * (size_t)i + 2u, vertices);
        float3 low = a < b ? a : b, high = a < b ? b : a;
        boxes_take(primitive(low < c ? low : c, high < c ? c : high, i), i, primitives, &joined, &centres);
    }
    box_join_keys(bounds, joined);
    box_join_keys(bounds + 6, centres);
}
