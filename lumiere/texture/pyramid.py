"""Pictures filtered down to a texel, for lookups over more than a texel."""

from __future__ import annotations

import numpy as np


def _halved(values: np.ndarray) -> np.ndarray:
    """``values`` with half as many rows, rounded down, each the mean over its share of them, (n, …) → (max(1, n // 2), …).

    Of an odd number n = 2 m + 1 each new row covers 2 + 1/m old ones (Guthe & Heckbert 2005, "Non-Power-of-Two Mipmap Creation").
    """
    n = len(values)
    m = n // 2
    if n < 2:
        return values
    if n % 2 == 0:
        return (values[0::2] + values[1::2]) / 2.0
    i = np.arange(m, dtype=values.dtype).reshape(-1, *[1] * (values.ndim - 1))
    return ((m - i) * values[0:2 * m:2] + m * values[1::2] + (i + 1) * values[2::2]) / n


def pyramid(values: np.ndarray) -> list[np.ndarray]:
    """``values`` (h, w, c), linear, and the ever smaller pictures down to (1, 1, c): each has half the width and height, rounded down but
    at least 1, and the same mean (Williams 1983, "Pyramidal Parametrics").
    """
    levels = [values]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(_halved(_halved(levels[-1]).swapaxes(0, 1)).swapaxes(0, 1))
    return levels
