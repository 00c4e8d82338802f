"""Scene-linear radiance → the 8-bit values of a screen."""

from __future__ import annotations

import numpy as np

from lumiere.errors import UsageError
from lumiere.film.tonemap import TONEMAPS


def srgb_encode(x: np.ndarray) -> np.ndarray:
    """sRGB-encoded value of a linear one in [0, 1] (IEC 61966-2-1:1999)."""
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 0.0031308) ** (1.0 / 2.4) - 0.055)


def check_tonemap(tonemap: str) -> None:
    """Raises UsageError where ``tonemap`` is none of the known names."""
    if tonemap not in TONEMAPS:
        raise UsageError(f"unknown tone map '{tonemap}', expected one of {', '.join(TONEMAPS)}")


def encode8(pixels: np.ndarray, exposure: float = 0.0, tonemap: str = "none") -> np.ndarray:
    """uint8 sRGB (..., 3) from linear Rec. 709: scaled by 2^``exposure``, tone-mapped, encoded, rounded to the nearest.

    Infinities are white, NaN is black. Raises UsageError where ``tonemap`` is unknown.
    """
    check_tonemap(tonemap)
    bounded = np.nan_to_num(np.asarray(pixels, dtype=np.float64), nan=0.0, posinf=1e30, neginf=0.0)
    display = TONEMAPS[tonemap](np.clip(bounded * 2.0**exposure, 0.0, 1e30))
    return np.floor(srgb_encode(display) * 255.0 + 0.5).astype(np.uint8)
