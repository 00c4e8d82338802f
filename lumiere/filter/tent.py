"""The tent filter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.filter import FILTERS, Filter


@FILTERS.register
@dataclass(kw_only=True)
class Tent(Filter):
    """The tent: weight falls linearly to 0 at the radius."""

    type: ClassVar[str] = "tent"
    default_radius: ClassVar[float] = 1.0

    def evaluate(self, x: np.ndarray) -> np.ndarray:
        return np.maximum(0.0, 1.0 - np.abs(x) / self.extent)
