"""The box filter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.filter import FILTERS, Filter


@FILTERS.register
@dataclass(kw_only=True)
class Box(Filter):
    """The box: every sample in the pixel counts the same."""

    type: ClassVar[str] = "box"
    default_radius: ClassVar[float] = 0.5

    def evaluate(self, x: np.ndarray) -> np.ndarray:
        return np.ones_like(x)

    def table(self) -> np.ndarray | None:
        return None
