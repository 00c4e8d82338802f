// The best of all planes between the centroids of a handful of primitives.

#include "accel/build/split.cl"

#define SMALL 4u

static inline float small_centre(float8 box, uint axis)
{
    float8 centre = box_centre(box);
    return axis == 0u ? centre.s0 : axis == 1u ? centre.s1 : centre.s2;
}

// Bit i of `sides`: primitive i goes left.
static inline split_t small_split(global const float8 *primitives, uint count, uint largest, float scale, uint *sides)
{
    split_t split = {INFINITY, 0u, NO_PLANE};
    ROLLED for (uint axis = 0u; axis < 3u; axis++) {
        float8 by_rank[SMALL];
        uint ones[SMALL] = {1u, 1u, 1u, 1u}, ranks[SMALL];
        for (uint i = 0u; i < count; i++) {
            float centre = small_centre(primitives[i], axis);
            ranks[i] = 0u;
            for (uint j = 0u; j < count; j++) {
                float other = small_centre(primitives[j], axis);
                ranks[i] += other < centre || (other == centre && j < i);
            }
            by_rank[ranks[i]] = primitives[i];
        }
        float before = split.cost;
        split_sweep(&split, axis, by_rank, ones, count, count, largest, scale);
        if (split.cost < before) {
            *sides = 0u;
            for (uint i = 0u; i < count; i++)
                *sides |= (uint)(ranks[i] <= split.last) << i;
        }
    }
    return split;
}
