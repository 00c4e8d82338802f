"""A plain list, for a handful of primitives and for unbounded ones."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from lumiere.accel.build import Topology, single_leaf


class Flat:
    """No nodes: the device tests every primitive. The boxes may be infinite."""

    name: ClassVar[str] = "flat"
    triangles_only: ClassVar[bool] = False
    holds_references: ClassVar[bool] = False

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology:
        """One leaf, the primitives in their own order."""
        return single_leaf(lower, upper)

    def encode(self, topology: Topology, records: np.ndarray) -> dict[str, np.ndarray]:
        """Nothing."""
        return {}
