"""As many samples for every pixel, until the picture's error is below the target."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lumiere.goal.error import Error, error_of_blocks
from lumiere.wavefront.batch import passes

if TYPE_CHECKING:
    from lumiere.rendering import Render

BLOCKS = 16
"""Blocks that are kept; when there are as many, each two become one of twice the size."""

FEWEST_SAMPLES, FEWEST_AT_ALL = 16, 1 << 16
"""Below so many samples of a pixel, and of the picture, nothing is decided: what makes the error must have had a chance to be met."""


def fewest(pixels: int) -> int:
    """Samples of each of ``pixels`` pixels before the first decision, a power of two."""
    return max(FEWEST_SAMPLES, min(512, 1 << math.ceil(math.log2(max(1.0, FEWEST_AT_ALL / pixels)))))


@dataclass(frozen=True)
class Outcome:
    """``error`` is None where too few samples were taken to tell."""

    error: Error | None
    reached: bool


def render_uniform(job: Render, target: float, spp_limit: int, keep_on: Callable[[int], bool]) -> Outcome:
    """Takes samples until the bound of the picture's relative error is at most ``target``, ``spp_limit`` is reached, or ``keep_on`` says False.

    ``keep_on`` is asked between batches, with an estimate of all the samples that it will take. The samples are those that any render of the
    same seed takes, so the picture is the one that a render of as many spp gives, bit by bit.
    """
    pixels = job.width * job.height
    size, done, expected = 1, 0, pixels * spp_limit
    blocks: list[np.ndarray] = []
    before = np.zeros(pixels)
    error = None
    while done < spp_limit:
        wanted = min(size, spp_limit - done)
        for batch in passes(done, wanted, pixels, job.wavefront.policy.batch):
            job.take(batch)
            if not keep_on(expected) and job.counts.min() == job.counts.max():
                return Outcome(error, False)
        done += wanted
        sums = job.luminance_sums()
        if wanted == size:
            blocks.append(((sums - before) / size).astype(np.float32))
        before = sums
        if done >= fewest(pixels) and len(blocks) >= BLOCKS // 2:
            error = error_of_blocks(np.stack(blocks))
            if error.bound <= target:
                return Outcome(error, True)
            expected = min(pixels * spp_limit, int(pixels * done * max(1.0, (error.bound / target) ** 2)))
        if len(blocks) == BLOCKS:
            blocks = [0.5 * (a + b) for a, b in zip(blocks[0::2], blocks[1::2], strict=True)]
            size *= 2
    return Outcome(error, False)
