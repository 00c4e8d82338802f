"""Discrete distributions with integer CDFs: probabilities are exact multiples of 2⁻³², so a pdf is what is sampled, whatever the table's size."""

from __future__ import annotations

import numpy as np

ONE = 1 << 32


def integer_cdf(weights: np.ndarray) -> np.ndarray:
    """(…, n) uint32 from weights (…, n) ≥ 0: entry i is where the share of i ends, less one. All weights 0: uniform.

    Entry i is drawn by a uniform 32-bit u with cdf[i − 1] < u ≤ cdf[i] (cdf[−1] = −1). A weight above 0 keeps at least one unit, and so does
    the first entry, whose share ends at 0 at least.
    """
    weights = np.asarray(weights, dtype=np.float64)
    peak = weights.max(axis=-1, keepdims=True)
    scaled = np.where(peak > 0.0, weights / np.where(peak > 0.0, peak, 1.0), 1.0)
    count = weights.shape[-1]
    shares = scaled / scaled.sum(axis=-1, keepdims=True) * (ONE - count)
    kept = (weights > 0.0) | (peak <= 0.0)
    kept[..., 0] = True
    units = np.floor(shares) + kept
    largest = units.argmax(axis=-1)[..., None]
    remainder = ONE - units.sum(axis=-1, keepdims=True)
    np.put_along_axis(units, largest, np.take_along_axis(units, largest, axis=-1) + remainder, axis=-1)
    return (np.cumsum(units, axis=-1) - 1.0).astype(np.uint64).astype(np.uint32)


def distribution_2d(weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """CDF over the rows (h,) and, within each row, over its columns (h · w,), both as ``integer_cdf``, of weights (h, w)."""
    return integer_cdf(weights.sum(axis=1)), integer_cdf(weights).ravel()
