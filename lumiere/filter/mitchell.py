"""The mitchell filter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.filter import FILTERS, Filter


@FILTERS.register
@dataclass(kw_only=True)
class Mitchell(Filter):
    """Mitchell & Netravali's cubic with B = C = 1/3 (1988, eq. 8): sharp, with negative lobes."""

    type: ClassVar[str] = "mitchell"
    default_radius: ClassVar[float] = 2.0

    def evaluate(self, x: np.ndarray) -> np.ndarray:
        t = np.abs(2.0 * x / self.extent)
        near = (7.0 * t**3 - 12.0 * t**2 + 16.0 / 3.0) / 6.0
        far = (-7.0 / 3.0 * t**3 + 12.0 * t**2 - 20.0 * t + 32.0 / 3.0) / 6.0
        return np.where(t < 1.0, near, np.where(t < 2.0, far, 0.0))
