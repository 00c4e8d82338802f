"""More samples where they lower the picture's error most.

Round by round some pixels get as many samples again as they have. Doubling a pixel of n samples, each of relative variance σ², lowers the mean square
error by σ² / 2n at a cost of n, so those with the largest σ / n come first; the counts tend to N ∝ σ, the best for the sum (Neyman 1934).

A pixel that chose by its own samples would be biased: one that happened to miss what is bright would stop, and stay dark. So σ² of a pixel
is that of its neighbours, and its own samples do not decide on it (Kirk & Arvo 1991 on why; the neighbours instead of a discarded pilot).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from lumiere.goal.error import FLOOR, Error, error_of_halves
from lumiere.goal.uniform import Outcome, fewest
from lumiere.wavefront.batch import listed, pixel_order

if TYPE_CHECKING:
    from lumiere.rendering import Render

REACH = 2
"""Neighbours at most so many pixels away, each way, tell a pixel's variance."""

LEAST_SHARE, MOST_SHARE = 0.125, 0.25
"""Every round adds at least and at most these parts of the samples taken so far: rounds cost time, and one that doubled all would choose nothing.
A round that would not fill the device is larger."""


def render_adaptive(job: Render, target: float, max_spp: int, keep_on: Callable[[int], bool]) -> Outcome:
    """Takes samples until the bound of the picture's relative error is at most ``target``, every pixel has ``max_spp``, or ``keep_on`` says
    False, which is asked between batches with an estimate of all the samples that it will take.
    """
    pixels, capacity = job.width * job.height, job.wavefront.policy.batch
    chosen = np.arange(pixels)
    first_half = min(fewest(pixels) // 2, max(1, max_spp // 2))  # what every pixel gets, in two halves
    more = np.full(pixels, first_half)
    for batch in listed(chosen, job.counts, more, capacity):
        job.take(batch)
    parts = _Parts(job.luminance_sums(), job.counts.astype(np.float64))
    more = np.minimum(more, max_spp - first_half)
    error = None
    while len(chosen) and more.min() > 0:
        for batch in listed(chosen, job.counts[chosen], more, capacity):
            job.take(batch)
            if not keep_on(int(job.counts.sum())):
                return Outcome(error, False)
        sums, deviations = job.luminance_sums_and_deviations()
        counts = job.counts.astype(np.float64)
        variance = _relative_variance(sums / counts, deviations)
        error = replace(parts.error(sums, counts), pixels=np.sqrt(variance / counts))
        if error.bound <= target:
            return Outcome(error, True)
        chosen = _next(job, variance, error, target, max_spp)
        parts.close_only(chosen, sums, counts)
        more = np.minimum(job.counts[chosen], max_spp - job.counts[chosen])
    return Outcome(error, False)


class _Parts:
    """Sums and counts of each pixel's samples up to its last doubling: its first part; what came since is the second."""

    def __init__(self, sums: np.ndarray, counts: np.ndarray) -> None:
        self.sums, self.counts = sums, counts

    def close_only(self, chosen: np.ndarray, sums: np.ndarray, counts: np.ndarray) -> None:
        """All that there is of the ``chosen`` pixels becomes the first part."""
        self.sums[chosen], self.counts[chosen] = sums[chosen], counts[chosen]

    def error(self, sums: np.ndarray, counts: np.ndarray) -> Error:
        """From the two parts of every pixel."""
        rest = counts - self.counts
        return error_of_halves(self.sums / self.counts, (sums - self.sums) / rest, self.counts, rest)


def _next(job: Render, relative_variance: np.ndarray, error: Error, target: float, max_spp: int) -> np.ndarray:
    """The pixels to double, ascending: the worthiest until the error would be half a deviation below the target, and no fewer than make a round."""
    counts = job.counts.astype(np.float64)
    variance = _of_neighbours(relative_variance, job.width, job.height)
    may = job.counts < max_spp
    worth = np.where(may, variance / counts**2, -1.0)
    order = np.argsort(-worth, kind="stable")
    order = order[may[order]]
    # The neighbours' variance says where the error is, the parts' difference how much there is of it.
    share = variance / counts
    scale = error.bound**2 / max(float(share.mean()), np.finfo(float).tiny)
    gain = np.cumsum(0.5 * scale * share[order]) / len(counts)
    cost = np.cumsum(np.minimum(counts[order], max_spp - counts[order]))
    enough = np.searchsorted(gain, error.bound**2 - 0.95 * target**2) + 1
    round_size = np.searchsorted(cost, max(LEAST_SHARE * counts.sum(), job.wavefront.policy.fill)) + 1
    most = np.searchsorted(cost, MOST_SHARE * counts.sum()) + 1
    return np.sort(order[:max(min(enough, most), round_size)])


def _relative_variance(luminance: np.ndarray, deviations: np.ndarray) -> np.ndarray:
    """(p,): variance of a sample's luminance relative to the pixel's luminance squared and the floor."""
    floor = FLOOR * luminance.mean() ** 2
    return deviations**2 / (np.maximum(luminance, 0.0) ** 2 + (floor if floor > 0.0 else 1.0))


def _of_neighbours(values: np.ndarray, width: int, height: int) -> np.ndarray:
    """Mean over the square around each pixel, itself left out; in device order, as ``values``."""
    order = pixel_order(width, height)
    grid = np.zeros(width * height)
    grid[order] = values
    grid = grid.reshape(height, width)
    total, count = _box(grid) - grid, _box(np.ones_like(grid)) - 1.0
    mean = np.divide(total, count, out=grid.copy(), where=count > 0.0)
    return np.maximum(mean, 0.0).ravel()[order]


def _box(grid: np.ndarray) -> np.ndarray:
    """Sums over squares of 2 REACH + 1 pixels, cut off at the border."""
    height, width = grid.shape
    padded = np.pad(grid, REACH)
    size = 2 * REACH + 1
    return sum(padded[i:i + height, j:j + width] for i in range(size) for j in range(size))
