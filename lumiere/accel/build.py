"""Boxes → topology: a binned SAH builder (Wald 2007), whole levels at a time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MAX_DEPTH = 48
"""No leaf is deeper (the root's depth is 0), so a traversal that defers one child a level needs no larger stack."""

BINS = 32
"""Where clusters lie far apart, as those of the benchmark's million triangles do, 16 cost a fifth more; 64 as much as 32 (docs/performance.md)."""

FEW = 64
"""Nodes of at most so many primitives have half the bins, and a builder half the work with them."""

SMALL = 4
NODES_AT_ONCE = 1 << 16


@dataclass
class Topology:
    """A binary tree over ``n`` primitives, as arrays over its ``m`` nodes. Node 0 is the root; without primitives there is no node.

    ``lower``, ``upper``: (m, 3) float32 bounds. ``left``: (m,) int32, the left child (the right one is ``left + 1``), or -1 at a leaf.
    ``first``, ``count``: (m,) uint32, the node's primitives as a range of ``order``. ``order``: (n,) uint32, the primitives in leaf order.
    ``depth``: of the deepest leaf. ``references``: None, or, where several leaves hold the same primitive (lumiere/accel/spatial.py), (r,) uint32: ranges
    are then of it, and it names places in ``order``.
    """

    lower: np.ndarray
    upper: np.ndarray
    left: np.ndarray
    first: np.ndarray
    count: np.ndarray
    order: np.ndarray
    depth: int
    references: np.ndarray | None = None

    @property
    def leaves(self) -> np.ndarray:
        """(m,) bool."""
        return self.left < 0

    @property
    def reference_arrays(self) -> dict[str, np.ndarray]:
        """What every layout that holds references has beside its own arrays: ``references`` where there are any."""
        return {} if self.references is None else {"references": self.references}


def single_leaf(lower: np.ndarray, upper: np.ndarray) -> Topology:
    """The topology of a plain list: one leaf, the primitives in their own order. Boxes of shape (n, 3), which may be infinite."""
    n = len(lower)
    nodes = min(n, 1)
    return Topology(
        lower=np.min(lower, axis=0, keepdims=True).astype(np.float32) if n else np.zeros((0, 3), np.float32),
        upper=np.max(upper, axis=0, keepdims=True).astype(np.float32) if n else np.zeros((0, 3), np.float32),
        left=np.full(nodes, -1, np.int32), first=np.zeros(nodes, np.uint32), count=np.full(nodes, n, np.uint32),
        order=np.arange(n, dtype=np.uint32), depth=0)


def build(lower: np.ndarray, upper: np.ndarray, max_leaf_size: int = 4, traversal_cost: float = 1.0, block: int = 1) -> Topology:
    """A topology of low surface-area cost over boxes.

    ``lower``, ``upper``: (n, 3) float32, finite, ``lower <= upper``. A node of at most ``max_leaf_size`` primitives becomes a leaf where
    splitting it would not lower the cost, one step of traversal costing ``traversal_cost`` intersections, which are made ``block``
    primitives at a time: a part of a block costs as much as a whole one. Nodes are split at the best of the planes between ``BINS`` equal bins
    of the centroids, or half of that where they are at most ``FEW``, on each of the three axes (Wald 2007, "On fast construction of SAH-based
    bounding volume hierarchies"), or of all planes between centroids where they are at most ``SMALL``; in the middle of the sorted centroids where
    no plane parts them, or where only halving keeps the depth within ``MAX_DEPTH``. Raises ValueError where a box is not as said.
    """
    lower, upper = np.asarray(lower, np.float32), np.asarray(upper, np.float32)
    if lower.ndim != 2 or lower.shape[1] != 3 or upper.shape != lower.shape:
        raise ValueError(f"found boxes of shapes {lower.shape} and {upper.shape}, expected (n, 3) twice")
    if not (np.isfinite(lower).all() and np.isfinite(upper).all() and (lower <= upper).all()):
        raise ValueError("found boxes that are inverted or not finite, expected lower <= upper")
    n = len(lower)
    if not 1 <= max_leaf_size or n > max_leaf_size << MAX_DEPTH:
        raise ValueError(f"found {n} primitives and leaves of {max_leaf_size}, expected leaves of at least 1")
    if n == 0:
        return single_leaf(lower, upper)

    order = np.zeros(n, np.uint32)
    levels: list[tuple[np.ndarray, ...]] = []
    nodes_before = 0
    # The primitives of the level's nodes, node after node, as rows: low x, y, z, high x, y, z.
    ids = np.arange(n, dtype=np.uint32)
    boxes = np.ascontiguousarray(np.concatenate([lower, upper], axis=1).T)
    first, count = np.zeros(1, np.int64), np.full(1, n, np.int64)
    while len(count):
        start = np.cumsum(count) - count
        low = np.stack([np.minimum.reduceat(row, start) for row in boxes[:3]])
        high = np.stack([np.maximum.reduceat(row, start) for row in boxes[3:]])
        largest_child = max_leaf_size << (MAX_DEPTH - len(levels) - 1) if len(levels) < MAX_DEPTH else 0
        open_nodes = count > min(max_leaf_size, traversal_cost * block)  # no split of the others could be cheaper
        split = best_splits(boxes, start, count, open_nodes, largest_child, block)

        area = half_area(low, high)
        keep_whole = (count <= max_leaf_size) & ~(traversal_cost * area + split.cost < blocks(count, block) * area)
        nodes_before += len(count)
        left = np.full(len(count), -1, np.int32)
        left[~keep_whole] = nodes_before + 2 * np.arange(np.count_nonzero(~keep_whole))
        levels.append((low.T, high.T, left, first, count))

        done = np.repeat(keep_whole, count)
        order[ranges(first[keep_whole], count[keep_whole])] = ids[done]
        if keep_whole.all():
            break
        if keep_whole.any():
            ids, boxes = ids[~done], np.compress(~done, boxes, axis=1)
            first, count = first[~keep_whole], count[~keep_whole]
            split = split.of(~keep_whole, ~done)
            start = np.cumsum(count) - count
        goes_left = sides(boxes, start, count, split)
        left_count = np.add.reduceat(goes_left, start, dtype=np.int64)
        by_side = _partition(goes_left, start, count, left_count)
        ids, boxes = ids[by_side], np.take(boxes, by_side, axis=1)
        first = np.stack([first, first + left_count], axis=1).ravel()
        count = np.stack([left_count, count - left_count], axis=1).ravel()

    low, high, left, first, count = (np.concatenate(parts) for parts in zip(*levels, strict=True))
    return Topology(lower=np.ascontiguousarray(low), upper=np.ascontiguousarray(high), left=left, first=first.astype(np.uint32),
                    count=count.astype(np.uint32), order=order, depth=len(levels) - 1)


def blocks(count: np.ndarray, block: int) -> np.ndarray:
    """Blocks that so many primitives fill or begin."""
    return -(-count // block)


def half_area(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Half the surface area of boxes given as (3, …) arrays; in float64, for neither an extent of 6e38 nor 1e30 squared is a float32."""
    x, y, z = np.subtract(high, low, dtype=np.float64)
    return x * (y + z) + y * z


def sah_cost(topology: Topology, traversal_cost: float = 1.0) -> float:
    """Expected cost of a ray that crosses the root's box, in intersections (MacDonald & Booth 1990); 0 without primitives."""
    area = half_area(topology.lower.T, topology.upper.T)
    if not len(area):
        return 0.0
    cost = np.where(topology.leaves, topology.count, traversal_cost)
    return float(area @ cost / area[0]) if area[0] > 0 else float(topology.count[0])


@dataclass
class Splits:
    """The best plane of each node: its cost (area × blocks on both sides; inf: none), axis and last bin on the left; each primitive's bins."""

    cost: np.ndarray
    axis: np.ndarray
    last: np.ndarray
    bins: np.ndarray

    def of(self, nodes: np.ndarray, primitives: np.ndarray) -> Splits:
        return Splits(self.cost[nodes], self.axis[nodes], self.last[nodes], np.compress(primitives, self.bins, axis=1))


def best_splits(boxes: np.ndarray, start: np.ndarray, count: np.ndarray, open_nodes: np.ndarray, largest_child: int, block: int) -> Splits:
    """The best splits of a level's open nodes into children of at most ``largest_child`` primitives."""
    best = Splits(np.full(len(count), np.inf), np.zeros(len(count), np.int8), np.zeros(len(count), np.uint8),
                   np.zeros((3, boxes.shape[1]), np.uint8))
    few, small = count <= FEW, count <= SMALL
    for chosen, bins in ((~few, BINS), (few & ~small, BINS // 2), (small, SMALL)):
        nodes = np.flatnonzero(open_nodes & chosen)
        for chunk in np.split(nodes, range(NODES_AT_ONCE, len(nodes), NODES_AT_ONCE)):
            if len(chunk):
                _best_splits_of(best, chunk, boxes, start, count, largest_child, block, bins)
    return best


def _best_splits_of(best: Splits, nodes: np.ndarray, boxes: np.ndarray, start: np.ndarray, count: np.ndarray, largest_child: int,
                    block: int, bins: int) -> None:
    """Sets ``best`` for some nodes, each of whose primitives goes into one of ``bins`` bins; ``SMALL``: by its rank."""
    local_count = count[nodes]
    if nodes[-1] - nodes[0] + 1 == len(nodes):
        primitives = slice(start[nodes[0]], start[nodes[-1]] + local_count[-1])
        local_boxes = boxes[:, primitives]
    else:
        primitives = ranges(start[nodes], local_count)
        local_boxes = np.take(boxes, primitives, axis=1)
    local_start = np.cumsum(local_count) - local_count
    node_of = np.repeat(np.arange(len(nodes)), local_count)
    cost, best_axis, last = np.full(len(nodes), np.inf), np.zeros(len(nodes), np.int8), np.zeros(len(nodes), np.uint8)
    for axis in range(3):
        half_centre = 0.25 * local_boxes[axis] + 0.25 * local_boxes[axis + 3]  # half of it, so that no extent overflows
        bin_of = _ranks(half_centre, local_start, node_of) if bins == SMALL else _equal_bins(half_centre, local_start, node_of, bins)
        histogram = _histogram(local_boxes, node_of, bin_of, bins, len(nodes))
        _sweep(cost, best_axis, last, axis, *histogram, largest_child, block)
        best.bins[axis, primitives] = bin_of
    best.cost[nodes], best.axis[nodes], best.last[nodes] = cost, best_axis, last


def _equal_bins(half_centre: np.ndarray, start: np.ndarray, node_of: np.ndarray, bins: int) -> np.ndarray:
    """Which of ``bins`` equal parts, from its node's least to its greatest, each centroid lies in."""
    least = np.minimum.reduceat(half_centre, start)
    extent = np.maximum.reduceat(half_centre, start) - least
    scale = np.float32(bins) / np.maximum(extent, np.finfo(np.float32).tiny * BINS)
    bin_of = ((half_centre - least[node_of]) * scale[node_of]).astype(np.int64)
    return np.minimum(bin_of, bins - 1, out=bin_of)


def _ranks(half_centre: np.ndarray, start: np.ndarray, node_of: np.ndarray) -> np.ndarray:
    """Each centroid's rank among the at most ``SMALL`` of its node."""
    rows = np.full((len(start), SMALL), np.inf, np.float32)
    column = np.arange(len(node_of)) - start[node_of]
    rows[node_of, column] = half_centre
    ranks = np.argsort(np.argsort(rows, axis=1, kind="stable"), axis=1)
    return ranks[node_of, column]


def _histogram(boxes: np.ndarray, node_of: np.ndarray, bin_of: np.ndarray, bins: int, nodes: int) -> tuple[np.ndarray, ...]:
    """Counts (bins, nodes) and bounds (3, bins, nodes), twice, of the primitives by bin and node."""
    key = node_of * bins + bin_of  # a node's bins lie together, as do its primitives
    low, high = np.full((3, nodes * bins), np.inf, np.float32), np.full((3, nodes * bins), -np.inf, np.float32)
    for axis in range(3):
        np.minimum.at(low[axis], key, boxes[axis])
        np.maximum.at(high[axis], key, boxes[axis + 3])
    count = np.bincount(key, minlength=nodes * bins)
    return tuple(np.ascontiguousarray(np.moveaxis(a.reshape(*a.shape[:-1], nodes, bins), -1, -2)) for a in (count, low, high))


def _sweep(best_cost: np.ndarray, best_axis: np.ndarray, best_last: np.ndarray, axis: int, count: np.ndarray, low: np.ndarray,
           high: np.ndarray, largest_child: int, block: int) -> None:
    """Lowers the nodes' best cost where a plane between two bins of ``axis`` costs less. The histogram is overwritten."""
    left_low, left_high = low[:, 0].copy(), high[:, 0].copy()
    left_count = count[:-1]
    left_cost = np.zeros(left_count.shape)
    with np.errstate(invalid="ignore", over="ignore"):  # an empty side costs inf × 0 = NaN, which is never less
        for i in range(len(left_count)):
            if i > 0:
                left_count[i] += left_count[i - 1]
                np.minimum(left_low, low[:, i], out=left_low)
                np.maximum(left_high, high[:, i], out=left_high)
            left_cost[i] = half_area(left_low, left_high) * blocks(left_count[i], block)
        total = left_count[-1] + count[-1]
        right_low, right_high = low[:, -1], high[:, -1]
        for i in reversed(range(len(left_count))):
            right_count = total - left_count[i]
            cost = left_cost[i] + half_area(right_low, right_high) * blocks(right_count, block)
            better = cost < best_cost
            if total.max() > largest_child:
                better &= np.maximum(left_count[i], right_count) <= largest_child
            np.copyto(best_cost, cost, where=better)
            np.copyto(best_axis, axis, where=better)
            np.copyto(best_last, i, where=better)
            np.minimum(right_low, low[:, i], out=right_low)
            np.maximum(right_high, high[:, i], out=right_high)


def sides(boxes: np.ndarray, start: np.ndarray, count: np.ndarray, split: Splits) -> np.ndarray:
    """Which primitives go left: those up to the split's plane; where there is none, the lower half along the widest axis."""
    node_of = np.repeat(np.arange(len(count)), count)
    bins = np.where(split.axis[node_of] == 0, split.bins[0], np.where(split.axis[node_of] == 1, split.bins[1], split.bins[2]))
    goes_left = bins <= split.last[node_of]

    halved = np.isinf(split.cost)
    if halved.any():
        of_halved = np.flatnonzero(halved[node_of])
        half_centres = 0.25 * boxes[:3, of_halved] + 0.25 * boxes[3:, of_halved]
        nodes = node_of[of_halved]
        local_count = count[halved]
        local_start = np.cumsum(local_count) - local_count
        extents = np.maximum.reduceat(half_centres, local_start, axis=1) - np.minimum.reduceat(half_centres, local_start, axis=1)
        widest = np.repeat(np.argmax(extents, axis=0), local_count)
        by_centre = np.lexsort((half_centres[widest, np.arange(len(nodes))], nodes))
        rank = np.arange(len(nodes)) - np.repeat(local_start, local_count)
        goes_left[of_halved[by_centre]] = rank < np.repeat((local_count + 1) // 2, local_count)
    return goes_left


def _partition(goes_left: np.ndarray, start: np.ndarray, count: np.ndarray, left_count: np.ndarray) -> np.ndarray:
    """The primitives' places, in the order: node after node, the left side before the right, each side in its old order."""
    left_before = np.cumsum(goes_left, dtype=np.int64)
    left_before -= goes_left
    left_rank = left_before - np.repeat(left_before[start], count)
    place = np.arange(len(goes_left))
    to = np.where(goes_left, np.repeat(start, count) + left_rank, place - left_rank + np.repeat(left_count, count))
    by_side = np.zeros(len(goes_left), np.int64)
    by_side[to] = place
    return by_side


def ranges(first: np.ndarray, count: np.ndarray) -> np.ndarray:
    """The numbers first, …, first + count - 1 of each range, range after range."""
    offset = np.cumsum(count) - count
    return np.arange(count.sum()) + np.repeat(first - offset, count)
