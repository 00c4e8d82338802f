"""A BVH of eight children a node and eight triangles a leaf, for devices with wide vectors and one ray a work-item (Wald, Benthin & Boulos 2008)."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from lumiere.accel.build import Topology, build, half_area

WIDTH = 8
LEAF = 1 << 31
COUNT_SHIFT = 28


class Bvh8:
    """256 bytes a node, four lines of a cache, and 292 a block of at most eight triangles.

    ``nodes``: (m, 8, 8) uint32, the first six rows float32: low x, high x, low y, high y, low z, high z of the eight children; absent ones have
    boxes that no ray meets. Then the children: a node's number, or 1 << 31 | a block's; by growing area, so that the last is the likeliest to stop a
    ray. Then nothing.
    ``blocks``: (b, 9, 8) float32: vertex 0 x, y, z, vertex 1 x, … of eight triangles; the last one fills what is left.
    ``ranges``: (b,) uint32: (count − 1) << 28 | the first primitive of the block.
    """

    name: ClassVar[str] = "bvh8"
    max_leaf_size: ClassVar[int] = WIDTH
    block: ClassVar[int] = WIDTH

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology:
        """A SAH topology with leaves of at most 8, a block of which costs the same however full it is."""
        return build(lower, upper, self.max_leaf_size, block=self.block)

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
        nodes = np.zeros((len(boxes), 8, WIDTH), np.uint32)
        nodes[:, :6] = np.ascontiguousarray(np.moveaxis(boxes, 1, 2), np.float32).view(np.uint32)
        nodes[:, 6] = reference
        return {"nodes": nodes,
                "blocks": np.ascontiguousarray(np.moveaxis(blocks, 1, 2), np.float32),
                "ranges": ((count - 1) << COUNT_SHIFT | first).astype(np.uint32)}


def _collapse(topology: Topology) -> np.ndarray:
    """(m, 8) int64: the binary nodes that become the children of each wide node, -1 for none; a node's inner children are wide nodes in this order.

    Of all choices that with the least area of wide nodes in all, the leaves being given (Ylitie et al. 2017, "Efficient Incoherent Ray Traversal
    on GPUs Through Compressed Wide BVHs", §3.1).
    """
    if not len(topology.left):
        return np.zeros((0, WIDTH), np.int64)
    if topology.leaves[0]:
        return np.array([[0] + [-1] * (WIDTH - 1)])
    area = half_area(topology.lower.T, topology.upper.T)
    shares = _shares(topology, area)
    levels = []
    roots = np.zeros(1, np.int64)
    while len(roots):
        slots = np.full((len(roots), WIDTH), -1, np.int64)
        allowed = np.zeros((len(roots), WIDTH), np.int64)  # how many children a slot's node may stand for
        slots[:, 0], allowed[:, 0] = roots, WIDTH
        rows = np.arange(len(roots))
        for _ in range(1, WIDTH):
            share = np.where(slots >= 0, shares[np.maximum(slots, 0), allowed], 0)
            column = share.argmax(axis=1)
            opens = np.flatnonzero(share[rows, column])
            if not len(opens):
                break
            column = column[opens]
            parent, left_share = slots[opens, column], share[opens, column]
            total = allowed[opens, column]
            free = (slots[opens] >= 0).sum(axis=1)
            slots[opens, column], allowed[opens, column] = topology.left[parent], left_share
            slots[opens, free], allowed[opens, free] = topology.left[parent] + 1, total - left_share
        keys = np.where(slots >= 0, area[np.maximum(slots, 0)], np.inf)
        slots = np.take_along_axis(slots, np.argsort(keys, axis=1, kind="stable"), axis=1)
        levels.append(slots)
        flat = slots[slots >= 0]
        roots = flat[~topology.leaves[flat]]
    return np.concatenate(levels)


def _shares(topology: Topology, area: np.ndarray) -> np.ndarray:
    """(m, 9) uint8: of the j children of a wide node that a binary node may stand for, how many its left child should; 0: it stands as one.

    Bottom up: cost[n, j] is the least area of the wide nodes in the subtree n where it is at most j children; as one, it is a leaf, or a wide node
    with eight of its own.
    """
    cost = np.zeros((len(area), WIDTH + 1))
    shares = np.zeros((len(area), WIDTH + 1), np.uint8)
    for nodes in reversed(_levels(topology)):
        nodes = nodes[~topology.leaves[nodes]]
        left, right = cost[topology.left[nodes]], cost[topology.left[nodes] + 1]
        parted, best = np.full((len(nodes), WIDTH + 1), np.inf), np.zeros((len(nodes), WIDTH + 1), np.uint8)
        for j in range(2, WIDTH + 1):
            for k in range(max(1, j - WIDTH + 1), min(WIDTH - 1, j - 1) + 1):
                sum_of_both = left[:, k] + right[:, j - k]
                better = sum_of_both < parted[:, j]
                parted[better, j], best[better, j] = sum_of_both[better], k
        cost[nodes, 1] = area[nodes] + parted[:, WIDTH]
        for j in range(2, WIDTH):
            fewer = cost[nodes, j - 1] <= parted[:, j]
            cost[nodes, j] = np.where(fewer, cost[nodes, j - 1], parted[:, j])
            best[fewer, j] = best[fewer, j - 1]
        shares[nodes] = best
    return shares


def _levels(topology: Topology) -> list[np.ndarray]:
    """The binary nodes, level by level."""
    levels, nodes = [], np.zeros(1, np.int64)
    while len(nodes):
        levels.append(nodes)
        left = topology.left[nodes[~topology.leaves[nodes]]].astype(np.int64)
        nodes = np.stack([left, left + 1], axis=1).ravel()
    return levels
