"""Triangles → topology with spatial splits (Stich, Friedrich & Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies"), whole levels at a time.

Where the children of an object split overlap, a node may be cut by a plane instead: a triangle that crosses it is then held on both sides, by a
reference each with the box of its part. So what is split here are references: a triangle's number and a box, which at first is the triangle's own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from lumiere.accel import Accelerator, Choice, layouts
from lumiere.accel.build import MAX_DEPTH, Topology, best_splits, blocks, half_area, ranges, sides, single_leaf
from lumiere.shape import DeviceShape, outwards
from lumiere.shape.triangle import Triangle

BINS = 16
"""Of a node's box, on each axis, for spatial splits; with 32 a build takes nearly twice as long and costs little less (docs/performance.md)."""

LEAST_OVERLAP = 1e-4
"""Of the children of an object split, as a part of the root's area, for a spatial one to be tried (the paper's α; docs/performance.md)."""

MOST_REFERENCES = 2.0
"""A triangle, on average. Meshes stay far below; only where triangles are long and lie across each other does the limit count (docs/performance.md)."""

PADDING = 2.0**-20
"""By so much of the triangle's largest extent is a part's box wider than the part: by as much may rounding displace the vertices, seen from a place
within that extent (shape/triangle_test.cl), so that a ray may meet the triangle just beside its part. Farther off, slabs have a margin of their own.
Of a million rays aimed at the faces of parts none was lost without it, and of those in bvh2 one in four hundred with as much taken away."""

AT_ONCE = 1 << 12
"""References that are sliced together: what they need stays in a cache."""


class SpatialSplits(Accelerator):
    """What ``layout`` makes of a topology with spatial splits. Only for triangles."""

    def __init__(self, layout: Accelerator) -> None:
        if not layout.holds_references:
            able = ", ".join(name for name, kind in layouts().items() if kind.holds_references)
            raise ValueError(f"found the layout {layout.name}, whose leaves cannot share a triangle, expected one of {able}")
        self.layout, self.name = layout, layout.name  # type: ignore[misc]

    def topology(self, shape: type[DeviceShape], records: np.ndarray) -> Topology:
        """The topology over triangles, whose boxes alone would not do."""
        return build(records["vertices"], self.layout.max_leaf_size, block=self.layout.block)

    def encode(self, topology: Topology, records: np.ndarray) -> dict[str, np.ndarray]:
        """As ``layout`` does."""
        return self.layout.encode(topology, records)


def with_spatial_splits(choice: Choice) -> Choice:
    """``choice``, but that trees over triangles are built with spatial splits where the layout can have them."""
    def chosen(shape: str, n_primitives: int, bounded: bool, wide: bool) -> Accelerator:
        accelerator = choice(shape, n_primitives, bounded, wide)
        return SpatialSplits(accelerator) if shape == "triangle" and accelerator.holds_references else accelerator

    return chosen


def build(vertices: np.ndarray, max_leaf_size: int = 4, traversal_cost: float = 1.0, block: int = 1) -> Topology:
    """A topology of low surface-area cost over triangles, ``vertices`` (n, 3, 3) float32, finite; the other arguments are those of
    ``lumiere.accel.build.build``, whose object splits are the alternative.

    Its ranges are of ``references``, unless no split was spatial. A spatial split is the best of 15 planes between 16 equal bins of the node's box, on
    each of the three axes; it is made where it costs less than the object split, those that gain most first, until there are ``MOST_REFERENCES`` a triangle.
    """
    if not np.isfinite(vertices).all():
        raise ValueError("found vertices that are not finite, expected finite ones")
    lower, upper = Triangle.bounds(np.rec.fromarrays([np.asarray(vertices, np.float32)], names="vertices"))
    if not len(lower):
        return single_leaf(lower, upper)
    ascending = along_each_axis(np.asarray(vertices, np.float32))
    spare = int((MOST_REFERENCES - 1.0) * len(lower))
    levels: list[tuple[np.ndarray, ...]] = []
    held: list[np.ndarray] = []
    nodes_before = 0
    # The level's references, node after node: their triangles, and boxes as rows: low x, y, z, high x, y, z.
    ids = np.arange(len(lower))
    boxes = np.ascontiguousarray(np.concatenate([lower, upper], axis=1).T)
    count = np.full(1, len(lower))
    root_area = half_area(lower.min(axis=0), upper.max(axis=0))
    while len(count):
        start = np.cumsum(count) - count
        low, high = np.minimum.reduceat(boxes[:3], start, axis=1), np.maximum.reduceat(boxes[3:], start, axis=1)
        area, whole = half_area(low, high), half_area(low, high) * blocks(count, block)
        largest_child = max_leaf_size << (MAX_DEPTH - len(levels) - 1) if len(levels) < MAX_DEPTH else 0
        open_nodes = count > min(max_leaf_size, traversal_cost * block)
        split = best_splits(boxes, start, count, open_nodes, largest_child, block)
        goes_left = sides(boxes, start, count, replace(split, cost=np.where(open_nodes, split.cost, 0.0)))

        # No child has more references than its parent, so that in a child that may have as many any spatial split keeps the depth.
        tried = open_nodes & (spare > 0) & (count <= largest_child) & (_overlap(boxes, start, goes_left) > LEAST_OVERLAP * root_area)
        planes = _best_planes(ascending, ids, boxes, start, count, np.flatnonzero(tried), low, high, block)
        spatial = (planes.cost < split.cost) & ((count > max_leaf_size) | (traversal_cost * area + planes.cost < whole))
        by_gain = np.argsort(np.subtract(planes.cost, split.cost, out=np.full(len(count), np.inf), where=spatial), kind="stable")
        spatial[by_gain[np.cumsum(np.where(spatial, planes.extra, 0)[by_gain]) > spare]] = False

        keep_whole = (count <= max_leaf_size) & ~(traversal_cost * area + np.where(spatial, planes.cost, split.cost) < whole)
        nodes_before += len(count)
        left = np.full(len(count), -1, np.int32)
        left[~keep_whole] = nodes_before + 2 * np.arange(np.count_nonzero(~keep_whole))
        levels.append((low.T, high.T, left, np.where(keep_whole, count, 0)))
        of_kept = np.repeat(keep_whole, count)
        held.append(ids[of_kept])

        to_left, to_right, left_boxes, right_boxes = _parted(ascending, ids, boxes, start, count, goes_left, spatial, planes)
        to_left, to_right = to_left & ~of_kept, to_right & ~of_kept
        child = 2 * np.repeat(np.cumsum(~keep_whole) - 1, count)
        child = np.concatenate([child[to_left], child[to_right] + 1])
        by_child = np.argsort(child, kind="stable")
        before = len(ids) - np.count_nonzero(of_kept)
        ids = np.concatenate([ids[to_left], ids[to_right]])[by_child]
        spare -= len(ids) - before
        boxes = np.concatenate([left_boxes[:, to_left], right_boxes[:, to_right]], axis=1)[:, by_child]
        count = np.bincount(child, minlength=2 * np.count_nonzero(~keep_whole))
    return _topology(levels, np.concatenate(held))


def _topology(levels: list[tuple[np.ndarray, ...]], held: np.ndarray) -> Topology:
    """From levels of nodes (their boxes, left children, and the leaves' counts) and the triangles that the leaves hold, leaf after leaf."""
    low, high, left, held_here = (np.concatenate(parts) for parts in zip(*levels, strict=True))
    bounds = np.cumsum([0] + [len(level[2]) for level in levels])
    inner = [begin + np.flatnonzero(left[begin:end] >= 0) for begin, end in pairwise(bounds)]
    count = held_here.astype(np.int64)
    for nodes in reversed(inner):
        count[nodes] = count[left[nodes]] + count[left[nodes] + 1]
    first = np.zeros_like(count)
    for nodes in inner:
        first[left[nodes]], first[left[nodes] + 1] = first[nodes], first[nodes] + count[left[nodes]]
    places = np.zeros(len(held), np.uint32)
    places[ranges(first[left < 0], count[left < 0])] = held
    # Triangles are stored once, in the order in which leaves first name them: those of a leaf lie near each other.
    triangles, named_first = np.unique(places, return_index=True)
    order = places[np.sort(named_first)]
    number = np.zeros(len(triangles), np.uint32)
    number[order] = np.arange(len(order), dtype=np.uint32)
    return Topology(lower=np.ascontiguousarray(low), upper=np.ascontiguousarray(high), left=left, first=first.astype(np.uint32),
                    count=count.astype(np.uint32), order=order, depth=len(levels) - 1,
                    references=number[places] if len(places) > len(order) else None)


def _overlap(boxes: np.ndarray, start: np.ndarray, goes_left: np.ndarray) -> np.ndarray:
    """Half the area of what the boxes of the two sides of each node have in common."""
    def side(chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return (np.minimum.reduceat(np.where(chosen, boxes[:3], np.inf), start, axis=1),
                np.maximum.reduceat(np.where(chosen, boxes[3:], -np.inf), start, axis=1))

    (left_low, left_high), (right_low, right_high) = side(goes_left), side(~goes_left)
    low, high = np.maximum(left_low, right_low), np.minimum(left_high, right_high)
    common = (low <= high).all(axis=0)
    return half_area(np.where(common, low, 0.0), np.where(common, high, 0.0))


@dataclass
class _Planes:
    """The best plane of each node: its cost (inf: none), axis and place, and how many references it adds."""

    cost: np.ndarray
    axis: np.ndarray
    at: np.ndarray
    extra: np.ndarray


def _best_planes(ascending: np.ndarray, ids: np.ndarray, boxes: np.ndarray, start: np.ndarray, count: np.ndarray, nodes: np.ndarray,
                 low: np.ndarray, high: np.ndarray, block: int) -> _Planes:
    """Those of ``nodes``, of whose boxes ``low`` and ``high`` (3, m) are corners."""
    best = _Planes(np.full(len(count), np.inf), np.zeros(len(count), np.int64), np.zeros(len(count)), np.zeros(len(count), np.int64))
    if not len(nodes):
        return best
    members = ranges(start[nodes], count[nodes])  # from here on, the references of these nodes
    ids, boxes = ids[members], boxes[:, members]
    node_of = np.repeat(np.arange(len(nodes)), count[nodes])
    for axis in range(3):
        origin = low[axis, nodes].astype(np.float64)
        width = (high[axis, nodes] - origin) / BINS
        per_width = np.divide(1.0, width, out=np.zeros_like(width), where=width > 0.0)
        # A reference that ends on a plane does not cross it.
        bin_of = [rounded((boxes[row] - origin[node_of]) * per_width[node_of]) for row, rounded in ((axis, np.floor), (axis + 3, np.ceil))]
        first = np.clip(bin_of[0], 0, BINS - 1).astype(np.int64)
        last = np.clip(bin_of[1] - 1, first, BINS - 1).astype(np.int64)
        begins, ends = (np.bincount(node_of * BINS + bins, minlength=len(nodes) * BINS).reshape(-1, BINS) for bins in (first, last))
        bin_low, bin_high = _bounds_of_bins(ascending[axis], axis, ids, boxes, node_of, origin, width, first, last)
        left_count = np.cumsum(begins, axis=1)[:, :-1]
        right_count = count[nodes][:, None] - np.cumsum(ends, axis=1)[:, :-1]
        with np.errstate(invalid="ignore", over="ignore"):  # an empty side costs inf × 0 = NaN
            left = half_area(np.minimum.accumulate(bin_low, axis=2), np.maximum.accumulate(bin_high, axis=2))[:, :-1]
            right = half_area(np.minimum.accumulate(bin_low[..., ::-1], axis=2), np.maximum.accumulate(bin_high[..., ::-1], axis=2))[:, -2::-1]
            cost = left * blocks(left_count, block) + right * blocks(right_count, block)
        cost = np.where(np.isfinite(cost) & (left_count > 0) & (right_count > 0), cost, np.inf)
        plane = np.argmin(cost, axis=1)
        row = np.arange(len(nodes))
        better = cost[row, plane] < best.cost[nodes]
        chosen, row, plane = nodes[better], row[better], plane[better]
        best.cost[chosen], best.axis[chosen], best.at[chosen] = cost[row, plane], axis, origin[row] + (plane + 1) * width[row]
        best.extra[chosen] = left_count[row, plane] + right_count[row, plane] - count[chosen]
    return best


def _bounds_of_bins(ascending: np.ndarray, axis: int, ids: np.ndarray, boxes: np.ndarray, node_of: np.ndarray, origin: np.ndarray, width: np.ndarray,
                    first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (3, nodes, bins), twice, of what references have in each bin; they reach from bin ``first`` to ``last``. Bins of a node begin at ``origin``."""
    low, high = np.full((3, len(origin) * BINS), np.inf, np.float32), np.full((3, len(origin) * BINS), -np.inf, np.float32)

    def include(bins: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> None:
        for row in range(3):
            np.minimum.at(low[row], bins, lower[row].astype(np.float32))  # ten times as fast as with another type
            np.maximum.at(high[row], bins, upper[row].astype(np.float32))

    lone = np.flatnonzero(first == last)
    include(node_of[lone] * BINS + first[lone], boxes[:3, lone], boxes[3:, lone])
    crossing = np.flatnonzero(first < last)
    for some in np.split(crossing, range(AT_ONCE, len(crossing), AT_ONCE)):
        spans = last[some] - first[some] + 1
        planes = np.repeat(origin[node_of[some]], spans + 1) + ranges(first[some], spans + 1) * np.repeat(width[node_of[some]], spans + 1)
        ends_at = np.cumsum(spans + 1)
        planes[ends_at - spans - 1], planes[ends_at - 1] = boxes[axis, some], boxes[axis + 3, some]
        triangles = ascending[:, :, ids[some]].astype(np.float64)
        lower, upper = slices(triangles, triangles[:, axis], planes, spans)
        of = np.repeat(some, spans)
        lower, upper = np.maximum(lower, boxes[:3, of]), np.minimum(upper, boxes[3:, of])
        there = (lower <= upper).all(axis=0)
        include((node_of[of] * BINS + ranges(first[some], spans))[there], lower[:, there], upper[:, there])
    return low.reshape(3, -1, BINS), high.reshape(3, -1, BINS)


def along_each_axis(vertices: np.ndarray) -> np.ndarray:
    """Triangles (n, 3, 3) with their vertices in ascending order along each axis: (axis, vertex, coordinate, n)."""
    order = np.argsort(vertices, axis=1)  # of the vertices, along each coordinate
    return np.stack([np.moveaxis(np.take_along_axis(vertices, order[:, :, axis, None], axis=1), 0, -1) for axis in range(3)])


def section(ascending: np.ndarray, along: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (3, n), twice, of where planes cut triangles, whose vertices, (vertex, coordinate, n) float64, ascend ``along`` an axis, (vertex, n): on the
    edge from the first to the last, and on one that meets the middle one. A plane beyond the triangle gives the vertex next to it.
    """
    def point(first: np.ndarray, last: np.ndarray, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
        part = np.divide(at - begin, end - begin, out=np.zeros_like(begin), where=end > begin)
        return first + np.clip(part, 0.0, 1.0) * (last - first)

    below = at < along[1]
    one = point(ascending[0], ascending[2], along[0], along[2])
    other = point(np.where(below, ascending[0], ascending[1]), np.where(below, ascending[1], ascending[2]),
                  np.where(below, along[0], along[1]), np.where(below, along[1], along[2]))
    return np.minimum(one, other), np.maximum(one, other)


def slices(ascending: np.ndarray, along: np.ndarray, planes: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (3, m), twice, of what planes slice triangles into (Sutherland & Hodgman 1974: the cuts, and the vertices between them), triangle after
    triangle. ``ascending``, ``along``: of n triangles as for ``section``; ``planes``: ``count`` + 1 of them for each, ascending; ``count``: (n,), of sum m.
    """
    triangle = np.repeat(np.arange(len(count)), count + 1)
    lower, upper = section(ascending[..., triangle], along[:, triangle], planes)
    first = np.cumsum(count + 1) - count - 1
    begin = ranges(first, count)  # the plane before each slice
    lower, upper = np.minimum(lower[:, begin], lower[:, begin + 1]), np.maximum(upper[:, begin], upper[:, begin + 1])
    triangle = np.repeat(np.arange(len(count)), count)
    middle = np.flatnonzero((planes[begin] <= along[1, triangle]) & (along[1, triangle] <= planes[begin + 1]))
    vertex = ascending[1][:, triangle[middle]]
    lower[:, middle], upper[:, middle] = np.minimum(lower[:, middle], vertex), np.maximum(upper[:, middle], vertex)
    return lower, upper


def _parted(ascending: np.ndarray, ids: np.ndarray, boxes: np.ndarray, start: np.ndarray, count: np.ndarray, goes_left: np.ndarray, spatial: np.ndarray,
            planes: _Planes) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Which references go left and which right, some both ways in ``spatial`` nodes, and their boxes on either side."""
    to_left, to_right, left_boxes, right_boxes = goes_left.copy(), ~goes_left, boxes.copy(), boxes.copy()
    node_of = np.repeat(np.arange(len(count)), count)
    cut = np.flatnonzero(spatial[node_of])
    if not len(cut):
        return to_left, to_right, left_boxes, right_boxes
    axis, at = planes.axis[node_of[cut]], planes.at[node_of[cut]]
    begin, end = boxes[axis, cut], boxes[axis + 3, cut]
    to_left[cut] = (begin < at) | (end <= at)
    to_right[cut] = end > at
    crosses = (begin < at) & (end > at)
    cut, axis, at = cut[crosses], axis[crosses], at[crosses]
    triangles = np.moveaxis(ascending[axis, :, :, ids[cut]].astype(np.float64), 0, -1)
    padding = PADDING * np.ptp(triangles, axis=0).max(axis=0)
    cuts = np.stack([boxes[axis, cut], at, boxes[axis + 3, cut]], axis=1).ravel()
    lower, upper = slices(triangles, triangles[:, axis, np.arange(len(cut))], cuts, np.full(len(cut), 2))
    with np.errstate(over="ignore"):  # what is past the largest float32 is brought back into the box below
        lower, upper = outwards(lower - np.repeat(padding, 2), upper + np.repeat(padding, 2))
    for side, to_side, side_boxes, other in ((0, to_left, left_boxes, to_right), (1, to_right, right_boxes, to_left)):
        side_boxes[:3, cut], side_boxes[3:, cut] = np.maximum(lower[:, side::2], boxes[:3, cut]), np.minimum(upper[:, side::2], boxes[3:, cut])
        there = (side_boxes[:3, cut] <= side_boxes[3:, cut]).all(axis=0)
        # Boxes are larger than parts, so that a part may be found to be none; but on one side each remains.
        side_boxes[:, cut[~there]] = boxes[:, cut[~there]]
        to_side[cut] = there | ~other[cut]
    _unsplit(cut, to_left, to_right, left_boxes, right_boxes, boxes, start, node_of)

    # Where one side has come out empty, it is the object split after all.
    empty = spatial & ((np.add.reduceat(to_left, start, dtype=np.int64) == 0) | (np.add.reduceat(to_right, start, dtype=np.int64) == 0))
    back = np.flatnonzero(empty[node_of])
    to_left[back], to_right[back] = goes_left[back], ~goes_left[back]
    left_boxes[:, back] = right_boxes[:, back] = boxes[:, back]
    return to_left, to_right, left_boxes, right_boxes


def _unsplit(cut: np.ndarray, to_left: np.ndarray, to_right: np.ndarray, left_boxes: np.ndarray, right_boxes: np.ndarray, boxes: np.ndarray,
             start: np.ndarray, node_of: np.ndarray) -> None:
    """Leaves those of the references ``cut`` that go both ways whole, on the side where that is cheaper than two parts (§4.4), each for itself."""
    cut = cut[to_left[cut] & to_right[cut]]
    node = node_of[cut]
    whole_low, whole_high = boxes[:3, cut], boxes[3:, cut]
    area, grown, number = [], [], []
    for to_side, side_boxes in ((to_left, left_boxes), (to_right, right_boxes)):
        low = np.minimum.reduceat(np.where(to_side, side_boxes[:3], np.inf), start, axis=1)[:, node]
        high = np.maximum.reduceat(np.where(to_side, side_boxes[3:], -np.inf), start, axis=1)[:, node]
        area.append(half_area(low, high))
        grown.append(half_area(np.minimum(low, whole_low), np.maximum(high, whole_high)))
        number.append(np.add.reduceat(to_side, start, dtype=np.int64)[node])
    both = area[0] * number[0] + area[1] * number[1]
    left_alone = grown[0] * number[0] + area[1] * (number[1] - 1)
    right_alone = area[0] * (number[0] - 1) + grown[1] * number[1]
    stays_left = (left_alone < both) & (left_alone <= right_alone)
    stays_right = (right_alone < both) & ~stays_left
    for stays, side_boxes, other in ((stays_left, left_boxes, to_right), (stays_right, right_boxes, to_left)):
        side_boxes[:, cut[stays]] = boxes[:, cut[stays]]
        other[cut[stays]] = False
