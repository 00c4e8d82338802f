// The blocks of triangles of lumiere/accel/bvh8.py, from vertices in leaf order. A leaf lies between two neighbouring splits of the order.

#include "accel/build/wide.cl"

#define ROWS 10u

KERNEL void blocks(global const float *vertices, global const uint *ranks, const uint count, const uint span, global float *blocks)
{
    uint begin = (uint)get_global_id(0) * span;
    if (begin >= count)
        return;
    for (uint first = begin; first < begin + min(span, count - begin); first++) {
        if (first > 0u && ranks[first] == ranks[first - 1u])
            continue;
        uint members = 1u;
        while (first + members < count && ranks[first + members] == ranks[first])
            members++;
        uint block = ranks[first];
        global float *to = blocks + ROWS * WIDTH * (size_t)block;
        for (uint i = 0u; i < WIDTH; i++) {
            global const float *from = vertices + 9u * (size_t)(first + min(i, members - 1u));
            for (uint row = 0u; row < 9u; row++)
                to[row * WIDTH + i] = from[row];
        }
        global uint *last = (global uint *)(to + 9u * WIDTH);
        last[0] = (members - 1u) << 28 | first;
        for (uint i = 1u; i < WIDTH; i++)
            last[i] = 0u;
    }
}
