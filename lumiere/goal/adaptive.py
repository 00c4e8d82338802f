"""More samples where they lower the picture's error most.

Round by round some pixels get as many samples again as they have. Doubling a pixel of n samples, each of relative variance σ², lowers the mean square
error by σ² / 2n at a cost of n, so those with the largest σ / n come first; the counts tend to N ∝ σ, the best for the sum (Neyman 1934).

A pixel that chose by its own samples would be biased: one that happened to miss what is bright would stop, and stay dark. So σ² of a pixel
is that of its neighbours, and its own samples do not decide on it (Kirk & Arvo 1991 on why; the neighbours instead of a discarded pilot).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from lumiere.goal.error import FLOOR, LUMINANCE, Error, error_of_halves
from lumiere.goal.uniform import Outcome, fewest
from lumiere.wavefront.batch import Batch, passes, pixel_order

if TYPE_CHECKING:
    from lumiere.rendering import Render

REACH = 2
"""Neighbours at most so many pixels away, each way, tell a pixel's variance."""

LEAST_SHARE, MOST_SHARE = 0.125, 0.25
"""Every round adds at least and at most these parts of the samples taken so far: rounds cost time, and one that doubled all would choose nothing."""


def render_adaptive(job: Render, target: float, max_spp: int, keep_on: Callable[[int], bool]) -> Outcome:
    """Takes samples until the bound of the picture's relative error is at most ``target``, every pixel has ``max_spp``, or ``keep_on`` says
    False, which is asked between batches with an estimate of all the samples that it will take.
    """
    pixels = job.width * job.height
    everything = np.arange(pixels)
    first_half = min(fewest(pixels) // 2, max(1, max_spp // 2))  # what every pixel gets, in two halves
    for batch in _batches(everything, 0, first_half, job):
        job.take(batch)
    parts = _Parts(np.zeros(pixels), np.zeros(pixels))
    parts.close(job.luminance_sums(), job.counts)
    wanted = [(everything, first_half, min(first_half, max_spp - first_half))]
    error = None
    while any(len(chosen) and more > 0 for chosen, _, more in wanted):
        for chosen, first, more in wanted:
            for batch in _batches(chosen, first, more, job):
                job.take(batch)
                if not keep_on(int(job.counts.sum())):
                    return Outcome(error, False)
        sums, counts = job.luminance_sums(), job.counts.astype(np.float64)
        error = replace(parts.error(sums, counts), pixels=np.sqrt(_relative_variance(job) / counts))
        if error.bound <= target:
            return Outcome(error, True)
        chosen = _next(job, error, target, max_spp)
        parts.close_only(chosen, sums, counts)
        wanted = [(group, int(n), int(min(n, max_spp - n))) for n, group in _by_count(chosen, job.counts)]
    return Outcome(error, False)


class _Parts:
    """Sums and counts of each pixel's samples up to its last doubling: its first part; what came since is the second."""

    def __init__(self, sums: np.ndarray, counts: np.ndarray) -> None:
        self.sums, self.counts = sums, counts

    def close(self, sums: np.ndarray, counts: np.ndarray) -> None:
        """All that there is becomes the first part."""
        self.sums, self.counts = sums.copy(), counts.astype(np.float64)

    def close_only(self, chosen: np.ndarray, sums: np.ndarray, counts: np.ndarray) -> None:
        """The same for the ``chosen`` pixels."""
        self.sums[chosen], self.counts[chosen] = sums[chosen], counts[chosen]

    def error(self, sums: np.ndarray, counts: np.ndarray) -> Error:
        """From the two parts of every pixel."""
        rest = counts - self.counts
        return error_of_halves(self.sums / self.counts, (sums - self.sums) / rest, self.counts, rest)


def _batches(chosen: np.ndarray, first_sample: int, more: int, job: Render) -> Iterator[Batch]:
    for batch in passes(first_sample, more, len(chosen), job.wavefront.policy.batch):
        yield replace(batch, pixels=chosen)


def _by_count(chosen: np.ndarray, counts: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """The chosen pixels, in order, by how many samples they have."""
    return [(int(n), chosen[counts[chosen] == n]) for n in np.unique(counts[chosen])]


def _next(job: Render, error: Error, target: float, max_spp: int) -> np.ndarray:
    """The pixels to double, ascending: the worthiest until the error would be half a deviation below the target, and no fewer than make a round."""
    counts = job.counts.astype(np.float64)
    variance = _of_neighbours(_relative_variance(job), job.width, job.height)
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
    round_size = np.searchsorted(cost, LEAST_SHARE * counts.sum()) + 1
    most = np.searchsorted(cost, MOST_SHARE * counts.sum()) + 1
    return np.sort(order[:max(min(enough, most), round_size)])


def _relative_variance(job: Render) -> np.ndarray:
    """(p,) in device order: variance of a sample's luminance, at most, relative to the pixel's luminance squared and the floor."""
    means, deviations = job.means_and_deviations()
    variance = (deviations @ LUMINANCE) ** 2
    luminance = means @ LUMINANCE
    floor = FLOOR * luminance.mean() ** 2
    return variance / (np.maximum(luminance, 0.0) ** 2 + (floor if floor > 0.0 else 1.0))


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
