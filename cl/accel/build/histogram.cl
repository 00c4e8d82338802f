// Counts and boxes of primitives by axis and bin, in a work-item's own memory.

#include "accel/build/split.cl"

static inline void histogram_fill(float8 *boxes, uint *counts, global const float8 *primitives, uint count, const grid_t *grid, uint bins)
{
    ROLLED for (uint i = 0u; i < 3u * bins; i++) {
        boxes[i] = box_nothing();
        counts[i] = 0u;
    }
    for (uint i = 0u; i < count; i++) {
        float8 box = primitives[i];
        const int4 at = grid_bins(grid, bins, box_centre(box));
        const uint x = (uint)at.x, y = bins + (uint)at.y, z = 2u * bins + (uint)at.z;
        boxes[x] = box_join(boxes[x], box);
        boxes[y] = box_join(boxes[y], box);
        boxes[z] = box_join(boxes[z], box);
        counts[x]++;
        counts[y]++;
        counts[z]++;
    }
}
