// Boxes to primitives, and the root's bounds. One work-item takes `span` of them.

#include "accel/build/tree.cl"

KERNEL void boxes(global const float *lower, global const float *upper, const uint count, const uint span, global float8 *primitives,
                  global uint *bounds)
{
    uint begin = (uint)get_global_id(0) * span;
    uint end = begin < count ? begin + min(span, count - begin) : begin;
    float8 joined = box_nothing(), centres = box_nothing();
    for (uint i = begin; i < end; i++) {
        float8 box = primitive(vload3(i, lower), vload3(i, upper), i);
        primitives[i] = box;
        joined = box_join(joined, box);
        centres = box_join(centres, box_centre(box));
    }
    if (begin < end) {
        box_join_keys(bounds, joined);
        box_join_keys(bounds + 6, centres);
    }
}
