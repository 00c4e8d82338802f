"""A binary topology → wide nodes of eight children: what the wide layouts share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lumiere.accel.build import Topology, half_area

WIDTH = 8
"""Children of a node."""

Arrange = Callable[[Topology, np.ndarray], np.ndarray]
"""Puts the children (m, 8) of wide nodes, binary nodes or -1, into the slots that a layout wants."""


def collapse(topology: Topology, arrange: Arrange) -> np.ndarray:
    """(m, 8) int64: the binary nodes that become the children of each wide node, -1 for none, in their slots; node 0 is the root, and the inner
    children of all nodes, node after node and slot after slot, are the wide nodes from 1 on.

    Of all choices that with the least area of wide nodes in all, the leaves being given (Ylitie et al. 2017, "Efficient Incoherent Ray Traversal
    on GPUs Through Compressed Wide BVHs", §3.1). A tree of one leaf gets a wide node above it.
    """
    if not len(topology.left):
        return np.zeros((0, WIDTH), np.int64)
    if topology.leaves[0]:
        return arrange(topology, np.array([[0] + [-1] * (WIDTH - 1)]))
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
        slots = arrange(topology, slots)
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
