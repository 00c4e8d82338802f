"""Renders that tests share, and how they are judged.

Building a scene's programs takes seconds, rendering a few thousand pixels does not: so tests vary values where they can (a light of power 0 is a
kind of light too), and not features.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pyopencl as cl
from scipy import stats

import lumiere
from lumiere.device.select import list_devices
from lumiere.film.image import Image
from tests.statistics import sidak

Array = np.ndarray
Json = dict[str, Any]

SIGNIFICANCE = 1e-4
"""Of one test: seeds are fixed, but a new device or compiler is a new draw."""

POINT_FILTER = {"type": "box", "radius": 1e-6}
"""Every sample at the pixel's centre, for values that are known point by point."""


@cache
def index_of(device: cl.Device) -> int:
    """The index by which ``lumiere.render`` takes ``device``."""
    return next(info.index for info in list_devices() if info.device == device)


def render(device: cl.Device, scene: Json, **options: Any) -> Image:
    """Renders the scene's inside, without a sample that is not finite."""
    image = lumiere.render({"scene": scene}, device=index_of(device), **options)
    assert image.record["non_finite"]["count"] == 0
    return image


def from_above(height: float, size: float) -> Json:
    """An orthographic camera at ``height`` that looks down on ``size`` × ``size`` metres about the origin: x to the right, z down the picture."""
    return {"type": "orthographic", "position": [0, height, 0], "look_at": [0, height - 1, 0], "up": [0, 0, -1], "height": size}


def ground(size: float, pixels: int) -> Array:
    """(pixels, pixels, 3) points with y = 0 under the centres of the pixels of ``from_above``."""
    at = ((np.arange(pixels) + 0.5) / pixels - 0.5) * size
    x, z = np.meshgrid(at, at)
    return np.stack([x, np.zeros_like(x), z], axis=-1)


def assert_exact(values: Array, expected: Array, roundings: int = 64, where: Array | None = None, terms: float = 0.0) -> None:
    """Equal but for the relative error of so many roundings to float32, of the value or of the largest of its ``terms``."""
    values, expected = np.broadcast_arrays(np.asarray(values, np.float64), expected)
    if where is not None:
        values, expected = values[where], expected[where]
    error, bound = np.abs(values - expected), roundings * 2.0**-24 * np.maximum(np.abs(expected), terms)
    worst = np.unravel_index(np.argmax(error - bound), error.shape)
    assert np.all(error <= bound), f"at {worst}: found {values[worst]}, expected {expected[worst]}"


def assert_mean(image: Image, expected: Array, where: Array | None = None, roundings: int = 64) -> None:
    """Independent samples whose mean should be ``expected``, (3,) or (h, w, 3): a z-test of the mean of all pixels, and a χ² test of groups of them.

    ``where`` (h, w) says which pixels count. A group has a thousand samples or more, of which its variance is estimated.
    """
    where = np.ones(image.pixels.shape[:2], bool) if where is None else where
    expected = np.broadcast_to(expected, image.pixels.shape)[where].astype(np.float64)
    size = max(1, -(-1024 // image.record["spp"]))
    groups = len(expected) // size
    assert groups >= 4, "too few samples to judge by"
    expected, found, variance = (a[:groups * size].reshape(groups, size, 3).mean(axis=1) for a in (
        expected, image.pixels[where].astype(np.float64), image.variance[where].astype(np.float64)))
    rounding = roundings * 2.0**-24 * np.abs(expected)
    difference, variance = found - expected, variance / size + 1e-30
    z = difference.mean(axis=0) / np.sqrt(variance.mean(axis=0) / groups + rounding.mean(axis=0) ** 2)
    level = sidak(SIGNIFICANCE, 6)
    assert np.all(np.abs(z) < stats.norm.isf(level / 2.0)), f"z {z}: found {found.mean(axis=0)}, expected {expected.mean(axis=0)}"
    squares = np.sum(difference**2 / (variance + rounding**2), axis=0)
    limit = stats.chi2.isf(level, groups)
    assert np.all(squares < limit), f"sum of z² {squares} over {groups} groups is beyond {limit}"
