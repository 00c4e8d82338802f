"""Dispersion in double precision, from its definition."""

from __future__ import annotations

import numpy as np

TENTS = ((549.0, 611.0, 700.0), (464.0, 549.0, 611.0), (400.0, 464.0, 549.0))
"""Of red, green and blue: where the sensitivity begins, is largest and ends, nm."""


def wavelength(u: np.ndarray | float, tent: tuple[float, float, float]) -> np.ndarray:
    """nm: below which a fraction ``u`` of a channel's sensitivity lies, by bisection of its integral."""
    low, peak, high = tent
    a, b = np.full(np.shape(u), low), np.full(np.shape(u), high)
    for _ in range(60):
        middle = 0.5 * (a + b)
        below = np.where(middle < peak, (middle - low) ** 2 / ((high - low) * (peak - low)), 1.0 - (high - middle) ** 2 / ((high - low) * (high - peak)))
        a, b = np.where(below < u, middle, a), np.where(below < u, b, middle)
    return 0.5 * (a + b)


def cauchy(ior: float, abbe_number: float, nm: np.ndarray | float) -> np.ndarray:
    """A + B / λ² through ``ior`` at the line d, with the Abbe number (n(d) − 1) / (n(F) − n(C))."""
    b = (ior - 1.0) / abbe_number / (486.13**-2 - 656.27**-2)
    return ior + b * (np.asarray(nm, float) ** -2 - 587.56**-2)


def channel_iors(ior: float, abbe_number: float | None, u: float) -> np.ndarray:
    """(3,) the channels' indices at ``u``."""
    if abbe_number is None:
        return np.full(3, float(ior))
    return np.array([cauchy(ior, abbe_number, wavelength(u, tent)) for tent in TENTS])
