"""Reconstruction filters: one file a kind.

A filter is importance-sampled (Ernst, Stamminger & Greiner 2006): each sample is placed by |f| and weighs f / |f| × ∫|f| / ∫f, so a pixel
depends on its own samples alone. Filters are separable; the device sees a table of the inverse CDF of |f| along one axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.registry import Registry
from lumiere.scene.fields import number

TABLE_SIZE = 256


@dataclass(kw_only=True)
class Filter:
    """A separable reconstruction filter. A subclass gives ``evaluate`` along one axis; the default ``radius`` is its own."""

    type: ClassVar[str]
    default_radius: ClassVar[float]
    radius: float | None = number(None, low=0.0, high=64.0, low_open=True, nullable=True, doc="half width, pixels")

    @property
    def extent(self) -> float:
        """The half width in use, pixels."""
        return self.default_radius if self.radius is None else self.radius

    def evaluate(self, x: np.ndarray) -> np.ndarray:
        """f(x) along one axis for x in [−extent, extent] pixels, up to a constant factor."""
        raise NotImplementedError

    def table(self) -> np.ndarray | None:
        """(TABLE_SIZE + 1, 2) float32: offsets at equal steps of the CDF of |f|, and the signed weight of the step that begins there.

        None where the filter is a box, whose offsets are uniform and weights 1.
        """
        edges = np.linspace(-self.extent, self.extent, 64 * TABLE_SIZE + 1)
        middles = (edges[1:] + edges[:-1]) / 2.0
        f = self.evaluate(middles)
        cdf = np.concatenate([[0.0], np.cumsum(np.abs(f))])
        steps = np.interp(np.linspace(0.0, cdf[-1], TABLE_SIZE + 1), cdf, edges)
        # The integral of f over each step, against the share 1 / TABLE_SIZE with which it is drawn: exact however coarse the table.
        integral = np.interp(steps, edges, np.concatenate([[0.0], np.cumsum(f)]))
        weights = np.diff(integral) * TABLE_SIZE / integral[-1]
        return np.stack([steps, np.append(weights, 0.0)], axis=1).astype(np.float32)


FILTERS: Registry[Filter] = Registry("lumiere.filter", "filter")
