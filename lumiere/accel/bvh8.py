"""A BVH of eight children a node and eight triangles a leaf, for devices with wide vectors and one ray a work-item (Wald, Benthin & Boulos 2008)."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from lumiere.accel import Accelerator
from lumiere.accel.build import Topology, build, half_area
from lumiere.accel.collapse import WIDTH, collapse

LEAF = 1 << 31
COUNT_SHIFT = 28


class Bvh8(Accelerator):
    """256 bytes a node and 320 a block of at most eight triangles: four and five lines of a cache.

    ``nodes``: (m, 8, 8) uint32, the first six rows float32: low x, high x, low y, high y, low z, high z of the eight children; absent ones have
    boxes that no ray meets. Then the children: a node's number, or 1 << 31 | a block's; by growing area, so that the last is the likeliest to stop a
    ray. Then nothing.
    ``blocks``: (b, 10, 8) float32: vertex 0 x, y, z, vertex 1 x, … of eight triangles; the last one fills what is left. Then, as uint32,
    (count − 1) << 28 | the first primitive of the block, and nothing.
    """

    name: ClassVar[str] = "bvh8"
    triangles_only: ClassVar[bool] = True
    holds_references: ClassVar[bool] = True
    max_leaf_size: ClassVar[int] = WIDTH
    block: ClassVar[int] = WIDTH

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology:
        """A SAH topology with leaves of at most 8, a block of which costs the same however full it is."""
        return build(lower, upper, self.max_leaf_size, block=self.block)

    def encode(self, topology: Topology, records: np.ndarray) -> dict[str, np.ndarray]:
        """The arrays above, for triangle ``records`` in leaf order."""
        children = collapse(topology, by_area)
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
        members = members if topology.references is None else topology.references[members]
        blocks = np.zeros((len(leaves), 10, WIDTH), np.float32)
        blocks[:, :9] = np.moveaxis(records["vertices"].reshape(-1, 9)[members], 1, 2)
        blocks[:, 9, 0] = ((count - 1) << COUNT_SHIFT | first).astype(np.uint32).view(np.float32)
        nodes = np.zeros((len(boxes), 8, WIDTH), np.uint32)
        nodes[:, :6] = np.ascontiguousarray(np.moveaxis(boxes, 1, 2), np.float32).view(np.uint32)
        nodes[:, 6] = reference
        return {"nodes": nodes, "blocks": blocks, **topology.reference_arrays}


def by_area(topology: Topology, children: np.ndarray) -> np.ndarray:
    """The children (m, 8) of each node by growing area, the absent ones last."""
    kept = np.maximum(children, 0)
    keys = np.where(children >= 0, half_area(np.moveaxis(topology.lower[kept], -1, 0), np.moveaxis(topology.upper[kept], -1, 0)), np.inf)
    return np.take_along_axis(children, np.argsort(keys, axis=1, kind="stable"), axis=1)
