"""The blackman-harris filter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.filter import FILTERS, Filter


@FILTERS.register
@dataclass(kw_only=True)
class BlackmanHarris(Filter):
    """The four-term Blackman–Harris window (Harris 1978, table 1), as Cycles' default."""

    type: ClassVar[str] = "blackman_harris"
    default_radius: ClassVar[float] = 1.5

    def evaluate(self, x: np.ndarray) -> np.ndarray:
        t = 2.0 * np.pi * (x / (2.0 * self.extent) + 0.5)
        return 0.35875 - 0.48829 * np.cos(t) + 0.14128 * np.cos(2.0 * t) - 0.01168 * np.cos(3.0 * t)
