// How each large node of a level is split, a work-item a node; and what is to be done with its children: split by chunks on the next level, or, once they
// are small, by a work-item each (subtrees.cl).

#include "accel/build/split.cl"
#include "accel/build/tree.cl"

// Puts a child, its side 0 or 1, among the next level's nodes or the subtrees. Their order is of no account.
static inline void choose_next(uint slot, uint first, uint count, uint turns, uint bounds, uint level, uint small, uint chunk_size, global open_t *next,
                               global chunk_t *next_chunks, global subtree_t *subtrees, global counters_t *counters)
{
    if (count <= small) {
        subtree_t subtree = {slot, first, count, turns, level};
        subtrees[atomic_inc(&counters->subtrees)] = subtree;
        return;
    }
    uint chunk_count = (count + chunk_size - 1u) / chunk_size, node = atomic_inc(counters->open + level);
    uint first_chunk = atomic_add(counters->chunks + level, chunk_count);
    open_t child = {slot, first, count, turns, bounds, first_chunk};
    next[node] = child;
    for (uint i = 0u; i < chunk_count; i++) {
        uint done = i * chunk_size;
        chunk_t chunk = {node, first + done, min(chunk_size, count - done), 0u};
        next_chunks[first_chunk + i] = chunk;
    }
}

KERNEL void choose(global counters_t *counters, const uint level, global const open_t *open, global chunk_t *chunks, global const uint *bounds,
                   global const uint *histogram_boxes, global const uint *histogram_counts, global const uint *chunk_counts,
                   const uint small, const uint chunk_size, global build_node_t *nodes, global uchar *turns, global uint *marks,
                   global plane_t *planes, global uint *side_bounds, global open_t *next, global chunk_t *next_chunks, global subtree_t *subtrees)
{
    uint i = (uint)get_global_id(0);
    if (i >= counters->open[level])
        return;
    for (uint side = 0u; side < 24u; side++)
        side_bounds[24u * i + side] = 0xffffffffu;
    open_t node = open[i];
    float8 box = box_of_keys(bounds + 12u * node.bounds);
    float scale = box_unit_scale(box);
    split_t split = {INFINITY, 0u, NO_PLANE};
    ROLLED for (uint axis = 0u; axis < 3u; axis++) {
        float8 boxes[BINS];
        uint counts[BINS];
        ROLLED for (uint b = 0u; b < BINS; b++) {
            size_t at = 3u * BINS * (size_t)i + axis * BINS + b;
            counts[b] = histogram_counts[at];
            boxes[b] = counts[b] ? box_of_keys(histogram_boxes + 6u * at) : box_nothing();
        }
        split_sweep(&split, axis, boxes, counts, BINS, node.count, largest_child(level), scale);
    }
    // Where the left ones of each chunk go.
    uint left = 0u, half_count = (node.count + 1u) / 2u;
    for (uint c = node.first_chunk; c < node.first_chunk + (node.count + chunk_size - 1u) / chunk_size; c++) {
        chunks[c].left = left;
        if (split.last == NO_PLANE)
            left += left + chunks[c].count <= half_count ? chunks[c].count : half_count - left;
        else
            left += chunk_counts[3u * BINS * (size_t)c + split.axis * BINS + split.last];
    }
    uint middle = node.first + left;
    plane_t plane = {split.axis, split.last, middle};
    planes[level * counters->room + i] = plane;
    node_store(nodes, node.slot, box, node.first, middle);
    turns[middle] = (uchar)(node.turns + 1u);
    marks[middle] = 1u;
    choose_next(2u * middle, node.first, left, node.turns + 1u, 2u * i, level + 1u, small, chunk_size, next, next_chunks, subtrees, counters);
    choose_next(2u * middle + 1u, middle, node.count - left, node.turns, 2u * i + 1u, level + 1u, small, chunk_size, next, next_chunks, subtrees,
                counters);
}
