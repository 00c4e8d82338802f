"""A binary BVH whose nodes hold both children's boxes (Aila & Laine 2009, "Understanding the efficiency of ray traversal on GPUs")."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from lumiere.accel import Accelerator
from lumiere.accel.build import Topology, build

LEAF = 1 << 31
COUNT_SHIFT = 28
MAX_LEAF_SIZE = 8
MAX_PRIMITIVES = 1 << COUNT_SHIFT


class Bvh2(Accelerator):
    """48 bytes of boxes and two child references an inner node; depth first, so that a left child follows its parent.

    ``nodes``: (m, 12) float32: left low x, left high x, left low y, left high y, the same of the right child, left low z, left high z,
    right low z, right high z. To be bound at an address that is a multiple of 16 bytes.
    ``children``: (m, 2) uint32: an inner node's number, or for a leaf 1 << 31 | (count - 1) << 28 | its first primitive.

    Node 0 is the root and always there: beside a lone leaf, or for want of any, stand boxes that no ray meets.
    """

    name: ClassVar[str] = "bvh2"
    holds_references: ClassVar[bool] = True
    max_leaf_size: ClassVar[int] = 4
    block: ClassVar[int] = 1

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology:
        """A SAH topology with leaves of at most 4."""
        return build(lower, upper, self.max_leaf_size, block=self.block)

    def encode(self, topology: Topology, records: np.ndarray) -> dict[str, np.ndarray]:
        """``nodes`` and ``children``. Raises ValueError for leaves or a number of primitives that a reference cannot hold."""
        places = len(topology.order if topology.references is None else topology.references)
        if places > MAX_PRIMITIVES:
            raise ValueError(f"found {places} primitives, expected at most {MAX_PRIMITIVES}")
        if np.any(topology.count[topology.leaves] > MAX_LEAF_SIZE):
            raise ValueError(f"found a leaf of {topology.count[topology.leaves].max()} primitives, expected at most {MAX_LEAF_SIZE}")
        leaves = topology.leaves
        parents = np.flatnonzero(~leaves)
        # A node comes after those whose range starts before its own, and before its descendants, whose ranges are shorter.
        parents = parents[np.lexsort((-topology.count[parents].astype(np.int64), topology.first[parents]))]
        reference = LEAF | (topology.count.astype(np.int64) - 1) << COUNT_SHIFT | topology.first
        reference[parents] = np.arange(len(parents))
        boxes = np.stack([topology.lower, topology.upper], axis=2).reshape(-1, 6)  # low x, high x, low y, …
        pairs = np.stack([topology.left[parents], topology.left[parents] + 1], axis=1)
        if not len(parents):
            # The root is a leaf, or there is none: it becomes the left child of a node that is not in the topology.
            reference = np.append(reference, [LEAF, LEAF])
            boxes = np.concatenate([boxes, np.tile(np.float32([np.inf, -np.inf]), (2, 3))])
            pairs = np.array([[0, 1]])
        of_pairs = boxes[pairs]
        nodes = np.concatenate([of_pairs[:, 0, :4], of_pairs[:, 1, :4], of_pairs[:, 0, 4:], of_pairs[:, 1, 4:]], axis=1)
        return {"nodes": np.ascontiguousarray(nodes, np.float32), "children": reference[pairs].astype(np.uint32), **topology.reference_arrays}
