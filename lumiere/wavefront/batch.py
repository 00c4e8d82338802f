"""Batches: which samples of which pixels are rendered together."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

BATCH = np.dtype([("first_pixel", "<u4"), ("pixel_count", "<u4"), ("samples_a_pixel", "<u4"), ("first_sample", "<u4"), ("sample_count", "<u4")])


FEWEST_ENTRIES = 1 << 20
"""A list of pixels has room for so many entries, or for one a pixel where that is more."""


@dataclass(frozen=True)
class Batch:
    """Samples ``first_sample`` … of the pixels ``first_pixel`` …, numbered through the crop in tiles of 8 × 8.

    Where the scene samples adaptively the device reads a list instead: ``entries`` (n, 2) uint32 holds a pixel's number and the first of
    ``samples_a_pixel`` samples; entries of one pixel follow one another, and ``pixel_count`` counts entries.
    """

    first_pixel: int
    pixel_count: int
    samples_a_pixel: int
    first_sample: int
    entries: np.ndarray | None = None

    @property
    def sample_count(self) -> int:
        """Samples of the batch."""
        return self.pixel_count * self.samples_a_pixel

    def count_into(self, counts: np.ndarray) -> None:
        """Adds the batch's samples to ``counts`` (pixels,), those that each pixel has."""
        if self.entries is None:
            counts[self.first_pixel:self.first_pixel + self.pixel_count] += self.samples_a_pixel
        else:
            counts += self.samples_a_pixel * np.bincount(self.entries[:, 0], minlength=len(counts))

    def record(self) -> np.ndarray:
        """The batch as the device reads it."""
        return np.array([(self.first_pixel, self.pixel_count, self.samples_a_pixel, self.first_sample, self.sample_count)], dtype=BATCH)


def passes(first_sample: int, samples_a_pixel: int, pixels: int, capacity: int) -> Iterator[Batch]:
    """Batches of at most ``capacity`` samples that give each of ``pixels`` pixels ``samples_a_pixel`` more samples.

    Where one sample of every pixel fits, a batch holds all pixels, so that the picture can be left after any of them.
    """
    if pixels <= capacity:
        at_once = max(1, capacity // pixels)
        for done in range(0, samples_a_pixel, at_once):
            yield Batch(0, pixels, min(at_once, samples_a_pixel - done), first_sample + done)
        return
    for sample in range(samples_a_pixel):
        for first in range(0, pixels, capacity):
            yield Batch(first, min(capacity, pixels - first), 1, first_sample + sample)


def listed(chosen: np.ndarray, first_samples: np.ndarray, more: np.ndarray, capacity: int) -> Iterator[Batch]:
    """Batches of at most ``capacity`` samples that give each of the pixels ``chosen`` ``more`` samples, from ``first_samples`` on; (n,) each."""
    at_once = int(np.gcd.reduce(more))
    if at_once > capacity:
        at_once = math.gcd(at_once, 1 << (capacity.bit_length() - 1))
    repeats = more // at_once
    number = np.arange(repeats.sum()) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    entries = np.stack([np.repeat(chosen, repeats), np.repeat(first_samples, repeats) + at_once * number], axis=1).astype(np.uint32)
    step = min(FEWEST_ENTRIES, capacity // at_once)
    for at in range(0, len(entries), step):
        part = entries[at:at + step]
        yield Batch(0, len(part), at_once, 0, part)


@lru_cache(maxsize=1)
def pixel_order(width: int, height: int) -> np.ndarray:
    """(width · height,) index y · width + x of the pixel with each number: tiles of 8 × 8, row after row (``film_sample`` in cl/lib/sampler.cl)."""
    y, x = np.arange(height)[:, None], np.arange(width)
    band_height = np.minimum(8, height - y // 8 * 8)
    tile_width = np.minimum(8, width - x // 8 * 8)
    number = (y // 8) * 8 * width + (x // 8) * 8 * band_height + (y % 8) * tile_width + x % 8
    order = np.zeros(width * height, dtype=np.int64)
    order[number.ravel()] = np.arange(width * height)
    order.flags.writeable = False  # shared with every caller
    return order
