"""A BVH of eight children a node and eight triangles a leaf, for devices with wide vectors and one ray a work-item (Wald, Benthin & Boulos 2008)."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from lumiere.accel.build import Topology, build, half_area

WIDTH = 8
LEAF = 1 << 31
COUNT_SHIFT = 28


class Bvh8:
    """224 bytes a node and 292 a block of at most eight triangles.

    ``nodes``: (m, 6, 8) float32: low x, high x, low y, high y, low z, high z of the eight children; absent ones have boxes that no ray meets.
    ``children``: (m, 8) uint32: a node's number, or 1 << 31 | a block's. By growing area, so that the last is the likeliest to stop a ray.
    ``blocks``: (b, 9, 8) float32: vertex 0 x, y, z, vertex 1 x, … of eight triangles; the last one fills what is left.
    ``ranges``: (b,) uint32: (count − 1) << 28 | the first primitive of the block.
    """

    name: ClassVar[str] = "bvh8"

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology:
        """A SAH topology with leaves of at most 8; a full block costs no more than a triangle, so nothing smaller than a block is split."""
        return build(lower, upper, max_leaf_size=WIDTH, traversal_cost=float(WIDTH))

    def encode(self, topology: Topology, records: np.ndarray) -> dict[str, np.ndarray]:
        """The arrays above, for triangle ``records`` in leaf order."""
        children = _collapse(topology)
        leaves = np.flatnonzero(topology.leaves)
        block_of = np.zeros(len(topology.left), np.uint32)
        block_of[leaves] = np.arange(len(leaves))
        wide_of = np.zeros(len(topology.left), np.uint32)
        inner = children[:, :, None]  # (m, 8, 1) binary nodes, -1 where absent
        owners = np.concatenate([np.zeros(1, np.int64), children[(children >= 0) & ~topology.leaves[children]]]) if len(children) else []
        wide_of[owners] = np.arange(len(owners))
        present = children >= 0
        safe = np.maximum(children, 0)
        boxes = np.stack([topology.lower[safe], topology.upper[safe]], axis=-1).reshape(*inner.shape[:2], 6)
        boxes = np.where(present[..., None], boxes, np.float32([np.inf, -np.inf] * 3))
        reference = np.where(topology.leaves[safe], LEAF | block_of[safe].astype(np.int64), wide_of[safe])
        reference = np.where(present, reference, 0)
        first, count = topology.first[leaves].astype(np.int64), topology.count[leaves].astype(np.int64)
        members = first[:, None] + np.minimum(np.arange(WIDTH), count[:, None] - 1)
        blocks = records["vertices"].reshape(-1, 9)[members]  # (b, 8, 9)
        return {"nodes": np.ascontiguousarray(np.moveaxis(boxes, 1, 2), np.float32), "children": reference.astype(np.uint32),
                "blocks": np.ascontiguousarray(np.moveaxis(blocks, 1, 2), np.float32),
                "ranges": ((count - 1) << COUNT_SHIFT | first).astype(np.uint32)}


def _collapse(topology: Topology) -> np.ndarray:
    """(m, 8) int64: the binary nodes that become the children of each wide node, -1 for none; a node's inner children are wide nodes in this order.

    Level by level, each wide node opens its largest inner child until it has eight.
    """
    area = half_area(topology.lower.T, topology.upper.T)
    levels = []
    if not len(topology.left):
        return np.zeros((0, WIDTH), np.int64)
    if topology.leaves[0]:
        levels.append(np.array([[0] + [-1] * (WIDTH - 1)]))
        return levels[0]
    roots = np.zeros(1, np.int64)
    while len(roots):
        slots = np.full((len(roots), WIDTH), -1, np.int64)
        slots[:, 0], slots[:, 1] = topology.left[roots], topology.left[roots] + 1
        rows = np.arange(len(roots))
        for filled in range(2, WIDTH):
            openable = (slots >= 0) & ~topology.leaves[np.maximum(slots, 0)]
            best = np.where(openable, area[np.maximum(slots, 0)], -1.0)
            column = best.argmax(axis=1)
            opens = best[rows, column] >= 0.0
            parent = slots[rows[opens], column[opens]]
            # Those that cannot open stay as they are; the free column of the others is the first unfilled one.
            free = (slots[opens] >= 0).sum(axis=1)
            slots[rows[opens], column[opens]] = topology.left[parent]
            slots[rows[opens], free] = topology.left[parent] + 1
            if not opens.any():
                break
            del filled
        keys = np.where(slots >= 0, area[np.maximum(slots, 0)], np.inf)
        slots = np.take_along_axis(slots, np.argsort(keys, axis=1, kind="stable"), axis=1)
        levels.append(slots)
        flat = slots[slots >= 0]
        roots = flat[~topology.leaves[flat]]
    return np.concatenate(levels)
