"""Tone maps: scene-linear to display-linear, both Rec. 709. Each maps black to black, rises, and stays in [0, 1].

All take and return float arrays of shape (..., 3); the sRGB encoding comes afterwards.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

# Hill 2016, "ACESFitted" (BakingLab): sRGB → ACES AP1 with the RRT's desaturation, and the way back from the ODT.
_ACES_IN = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
_ACES_OUT = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])

# Wrench 2023, "Minimal AgX Implementation": Sobotka's inset, its inverse, and the sigmoid as a polynomial, highest power first.
_AGX_INSET = np.array([
    [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
    [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
    [0.0423756549057051, 0.0784336, 0.879142973793104]])
_AGX_OUTSET = np.array([
    [1.19687900512017, -0.0980208811401368, -0.0990297440797205],
    [-0.0528968517574562, 1.15190312990417, -0.0989611768448433],
    [-0.0529716355144438, -0.0980434501171241, 1.15107367264116]])
_AGX_SIGMOID = (15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232)
_AGX_STOPS = (-12.47393, 4.026069)

_FILMIC_WHITE = 11.2
_FILMIC_EXPOSURE = 2.0


def none(rgb: np.ndarray) -> np.ndarray:
    """Clips."""
    return np.clip(rgb, 0.0, 1.0)


def aces(rgb: np.ndarray) -> np.ndarray:
    """Hill's fit of the ACES reference and output transforms for sRGB monitors (Hill 2016)."""
    x = np.maximum(rgb, 0.0) @ _ACES_IN.T
    fitted = (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081)
    return np.clip(fitted @ _ACES_OUT.T, 0.0, 1.0)


def agx(rgb: np.ndarray) -> np.ndarray:
    """Sobotka's AgX (2022), base look, in Wrench's polynomial form (2023); its 2.2 display power is undone at the end."""
    low, high = _AGX_STOPS
    x = np.maximum(rgb, 0.0) @ _AGX_INSET.T
    x = (np.clip(np.log2(np.maximum(x, 2.0**low)), low, high) - low) / (high - low)
    return np.clip(np.polyval(_AGX_SIGMOID, x) @ _AGX_OUTSET.T, 0.0, 1.0) ** 2.2


def _hable(x: np.ndarray | float) -> np.ndarray | float:
    """Hable 2010, "Filmic Tonemapping Operators": shoulder 0.15, linear part 0.5 at 0.1, toe 0.2, 0.02 / 0.3."""
    return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3


def filmic(rgb: np.ndarray) -> np.ndarray:
    """Hable's curve for Uncharted 2 (Hable 2010), linear white 11.2, exposure bias 2."""
    return np.clip(_hable(_FILMIC_EXPOSURE * np.maximum(rgb, 0.0)) / _hable(_FILMIC_WHITE), 0.0, 1.0)


TONEMAPS: dict[str, Callable[[np.ndarray], np.ndarray]] = {"none": none, "aces": aces, "agx": agx, "filmic": filmic}
