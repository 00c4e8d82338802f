"""A compressed BVH of eight children a node, for GPUs (Ylitie, Karras & Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed
Wide BVHs")."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np

from lumiere.accel.build import Topology, build
from lumiere.accel.collapse import WIDTH, collapse

MAX_LEAF_SIZE = 3
NODE_BYTES = 80
FIRST_INNER_BIT = 24
STEPS = 255
"""Of the grid that a node's children's boxes are rounded to, along each axis."""

LEAST_EXPONENT, LARGEST_EXPONENT = -126, 121
"""Of the grid's step: that of the least normal number, and one with which the grid spans all finite numbers."""


class Cwbvh:
    """80 bytes a node. The primitives of a node's leaves lie together, so ``build`` has an order of its own.

    ``nodes``: (m, 20) uint32, node 0 the root. Words 0 to 2: the lowest corner p, float32. Word 3, bytes: the exponents of the grid's steps along
    x, y, z, biased by 127; the slots that hold nodes, a bit each. Word 4: the number of the first node among the children, which follow each other in
    the order of their slots. Word 5: the first primitive of the leaves. Words 6 and 7: a byte a slot: 0 where there is no child; 1 << 5 | 24 + slot
    for a node; for a leaf of 1, 2 or 3 primitives 1, 3 or 7, << 5, | its first primitive's place among those of the node. Words 8 to 19: bytes, low x,
    y, z and high x, y, z of the eight slots' boxes in steps from p, rounded outwards. To be bound at an address that is a multiple of 16 bytes.

    A child lies in the slot whose bits 2, 1, 0 say on which side of the node's centre it is along x, y, z, as far as others do not claim it more.
    """

    name: ClassVar[str] = "cwbvh"
    triangles_only: ClassVar[bool] = False
    holds_references: ClassVar[bool] = False

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology:
        """A SAH topology with leaves of at most 3, whose ``order`` has the leaves of each wide node together: inner nodes are no ranges of it."""
        topology = build(lower, upper, max_leaf_size=MAX_LEAF_SIZE)
        children = collapse(topology, by_octant)
        leaves = children[(children >= 0) & topology.leaves[children]]
        count = topology.count[leaves].astype(np.int64)
        offset = np.cumsum(count) - count
        first = topology.first.copy()
        order = topology.order[np.arange(count.sum()) + np.repeat(first[leaves] - offset, count)]
        first[leaves] = offset
        return replace(topology, first=first, order=order)

    def encode(self, topology: Topology, records: np.ndarray) -> dict[str, np.ndarray]:
        """``nodes``. Raises ValueError for leaves of more than 3 primitives, or where those of a node are not together."""
        if np.any(topology.count[topology.leaves] > MAX_LEAF_SIZE):
            raise ValueError(f"found a leaf of {topology.count[topology.leaves].max()} primitives, expected at most {MAX_LEAF_SIZE}")
        children = collapse(topology, by_octant)
        present = children >= 0
        kept = np.maximum(children, 0)
        is_leaf = present & topology.leaves[kept]
        inner = present & ~is_leaf

        counts = np.where(is_leaf, topology.count[kept].astype(np.int64), 0)
        begin = topology.first[kept].astype(np.int64)
        first = np.where(is_leaf, begin, len(topology.order)).min(axis=1, initial=len(topology.order))
        last = np.where(is_leaf, begin + counts, 0).max(axis=1, initial=0)
        if np.any(is_leaf.any(axis=1) & (last - first != counts.sum(axis=1))):
            raise ValueError("found a node's leaves apart, expected them together, as Cwbvh.build has them")
        places = np.where(is_leaf, begin - first[:, None], 0)
        inner_counts = inner.sum(axis=1)

        nodes = np.zeros((len(children), NODE_BYTES), np.uint8)
        words = nodes.view("<u4")
        low, high = (np.moveaxis(box[kept], -1, 1).astype(np.float64) for box in (topology.lower, topology.upper))  # (m, 3, 8)
        corner, exponent, low_steps, high_steps = _quantised(low, high, present[:, None, :])
        words[:, :3] = corner.astype("<f4").view("<u4")
        nodes[:, 12:15] = exponent + 127
        nodes[:, 15] = np.packbits(inner, axis=1, bitorder="little")[:, 0]
        words[:, 4] = 1 + np.cumsum(inner_counts) - inner_counts
        words[:, 5] = first
        unary = (1 << counts) - 1
        nodes[:, 24:32] = np.where(is_leaf, unary << 5 | places, np.where(inner, 1 << 5 | FIRST_INNER_BIT + np.arange(WIDTH), 0))
        nodes[:, 32:56] = low_steps.reshape(-1, 3 * WIDTH)
        nodes[:, 56:80] = high_steps.reshape(-1, 3 * WIDTH)
        return {"nodes": words.astype(np.uint32)}


def _quantised(low: np.ndarray, high: np.ndarray, present: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Boxes (m, 3, 8) on their node's grid: its corner (m, 3), the exponents of its steps (m, 3), the boxes' corners in steps (m, 3, 8).

    Doubles round here by 2^-53 of a distance from the corner; the traversal allows for 2^-21 of it.
    """
    corner = np.where(present, low, np.inf).min(axis=2, initial=np.inf)
    extent = np.where(present, high, -np.inf).max(axis=2, initial=-np.inf) - corner
    exponent = np.clip(np.frexp(extent / STEPS)[1], LEAST_EXPONENT, LARGEST_EXPONENT)
    step = np.ldexp(1.0, exponent)[..., None]
    low_steps = np.where(present, np.floor((low - corner[..., None]) / step), 0)
    high_steps = np.where(present, np.ceil((high - corner[..., None]) / step), 0)
    return corner, exponent, low_steps, high_steps


def by_octant(topology: Topology, children: np.ndarray) -> np.ndarray:
    """The children (m, 8) in the slots that suit where they lie: of all pairs of a child and a slot that are left, the one that gains most is taken
    first, where a child gains by what of its centre's way from the node's centre points into the slot's octant (Ylitie et al. 2017, §3.2, greedily).
    """
    present = children >= 0
    kept = np.maximum(children, 0)
    low, high = topology.lower[kept].astype(np.float64), topology.upper[kept].astype(np.float64)  # (m, 8, 3)
    center = 0.5 * (np.where(present[..., None], low, np.inf).min(axis=1) + np.where(present[..., None], high, -np.inf).max(axis=1))
    sides = np.where(np.arange(WIDTH)[:, None] >> np.array([2, 1, 0]) & 1, 1.0, -1.0)  # (slot, axis)
    gain = (0.5 * (low + high) - center[:, None]) @ sides.T
    gain[~present] = -np.inf
    arranged = np.full_like(children, -1)
    rows = np.arange(len(children))
    for _ in range(WIDTH):
        child, slot = np.divmod(gain.reshape(len(children), -1).argmax(axis=1), WIDTH)
        taken = gain[rows, child, slot] > -np.inf
        arranged[rows[taken], slot[taken]] = children[rows[taken], child[taken]]
        gain[rows, child, :] = -np.inf
        gain[rows, :, slot] = -np.inf
    return arranged
