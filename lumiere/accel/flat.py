"""A plain list, for a handful of primitives and for unbounded ones."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from lumiere.accel import Accelerator
from lumiere.accel.build import Topology, single_leaf


class Flat(Accelerator):
    """No nodes: the device tests every primitive. The boxes may be infinite."""

    name: ClassVar[str] = "flat"

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology:
        """One leaf, the primitives in their own order."""
        return single_leaf(lower, upper)

    def encode(self, topology: Topology, records: np.ndarray) -> dict[str, np.ndarray]:
        """Nothing."""
        return {}
