"""The gaussian filter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.filter import FILTERS, Filter


@FILTERS.register
@dataclass(kw_only=True)
class Gaussian(Filter):
    """A Gaussian with a standard deviation of a third of the radius, lowered to reach 0 at the radius (PBR 4ed, §8.8.3)."""

    type: ClassVar[str] = "gaussian"
    default_radius: ClassVar[float] = 1.5

    def evaluate(self, x: np.ndarray) -> np.ndarray:
        sigma = self.extent / 3.0
        return np.maximum(0.0, np.exp(-0.5 * (x / sigma) ** 2) - np.exp(-4.5))
