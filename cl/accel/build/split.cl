// The best plane between bins of centroids (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies").
// As lumiere/accel/build.py does it, which says more.

#include "accel/build/primitive.cl"

#define NO_PLANE 0xffffffffu

typedef struct {
    float cost;  // area times blocks on both sides, in the node's scale
    uint axis;
    uint last;  // bin on the left; NO_PLANE: the first half goes there
} split_t;

// Bins of equal width over the centroids, BINS of them, or of a node of few primitives half as many.
typedef struct {
    float4 least;
    float4 scale;
} grid_t;

static inline grid_t grid_over(float8 centres, uint bins)
{
    grid_t grid;
    float3 extent = -centres.s456 - centres.s012;
    grid.least = (float4)(centres.s012, 0.0f);
    grid.scale = (float4)((float)bins / (extent > 0x1p-122f ? extent : (float3)(0x1p-122f)), 0.0f);
    return grid;
}

// The bins on the three axes of a centroid.
static inline int4 grid_bins(const grid_t *grid, uint bins, float8 centre)
{
    const int4 at = convert_int4((centre.s0123 - grid->least) * grid->scale), last = (int4)((int)bins - 1);
    return at < last ? at : last;
}

static inline uint grid_bin(const grid_t *grid, uint bins, uint axis, float8 centre)
{
    const int4 at = grid_bins(grid, bins, centre);
    return (uint)(axis == 0u ? at.x : axis == 1u ? at.y : at.z);
}

static inline uint blocks_of(uint count)
{
    return (count + BLOCK - 1u) / BLOCK;
}

// The most primitives that a child of a node at `level` may hold without growing deeper than MAX_DEPTH.
static inline uint largest_child(uint level)
{
    uint levels_left = MAX_DEPTH - 1u - level;
    return level >= MAX_DEPTH ? 0u : levels_left >= 28u ? 0xffffffffu : MAX_LEAF_SIZE << levels_left;
}

// Lowers `best` where a plane between two of the `bins` bins of an axis costs less.
static inline void split_sweep(split_t *best, uint axis, const float8 *boxes, const uint *counts, uint bins, uint total, uint largest, float scale)
{
    float left_cost[BINS];
    float8 box = box_nothing();
    uint left = 0u;
    ROLLED for (uint i = 0u; i + 1u < bins; i++) {
        box = box_join(box, boxes[i]);
        left += counts[i];
        left_cost[i] = box_area(box, scale) * (float)blocks_of(left);
    }
    box = box_nothing();
    uint right = 0u;
    ROLLED for (uint i = bins - 1u; i-- > 0u;) {
        box = box_join(box, boxes[i + 1u]);
        right += counts[i + 1u];
        left = total - right;
        float cost = left_cost[i] + box_area(box, scale) * (float)blocks_of(right);
        if (left > 0u && right > 0u && cost < best->cost && left <= largest && right <= largest) {
            best->cost = cost;
            best->axis = axis;
            best->last = i;
        }
    }
}
