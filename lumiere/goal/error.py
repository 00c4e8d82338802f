"""The error of a picture from the scatter between parts of its own samples.

The sample variance, divided by the number of samples, overstates the error of stratified and Sobol points, whose samples avoid each other.
Here a pixel's samples are parted into blocks that follow one another; the variance between blocks, each of which is a stratified set of
its own, is nearer to the truth, and on the safe side of it as long as blocks repel each other as well (Owen 1997: nets of a scrambled sequence).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FLOOR = 0.01
"""Errors are relative to √(Y² + FLOOR m²), Y the pixel's luminance and m the picture's mean."""

DEVIATIONS = 3.0
"""Standard deviations of the estimate by which the error has to be below the target. Errors of pixels that few bright samples make are dominated by
few pixels; then this also stands for samples as bright that have not been met yet."""

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class Error:
    """Relative standard errors: ``pixels`` (p,) of each, ``image`` their root mean square, and ``bound`` that ``image`` is surely below."""

    pixels: np.ndarray
    image: float
    bound: float


def _stated(squares: np.ndarray, blocks: float) -> Error:
    """From squared relative errors that were estimated from ``blocks`` equal blocks each.

    What is bounded is the actual mean square error D, not its expectation V. With normal errors D has the variance 2 Σσ⁴ / p², its estimate
    2 Σσ⁴ / ((blocks − 1) p²), and the mean of s⁴ is σ⁴ (blocks + 1) / (blocks − 1).
    """
    count = len(squares)
    mean = float(squares.mean())
    fourth = float(np.square(squares).sum()) * (blocks - 1.0) / (blocks + 1.0)
    deviation = (2.0 * fourth * (1.0 + 1.0 / (blocks - 1.0))) ** 0.5 / count
    return Error(np.sqrt(squares), mean**0.5, (mean + DEVIATIONS * deviation) ** 0.5)


def error_of_blocks(blocks: np.ndarray) -> Error:
    """From the luminance of ``blocks`` (k, p) of as many samples each, k ≥ 2.

    A pixel's luminance is taken to be the median over its blocks, so that one bright sample does not make its own error look small.
    """
    count = len(blocks)
    level = np.median(blocks, axis=0)
    squares = blocks.var(axis=0, ddof=1, dtype=np.float64) / count / _denominator(level, float(np.median(blocks.mean(axis=1))))
    return _stated(squares, float(count))


def error_of_halves(first: np.ndarray, second: np.ndarray, first_counts: np.ndarray, second_counts: np.ndarray) -> Error:
    """From the mean luminance (p,) of two parts of each pixel's samples, of ``first_counts`` and ``second_counts`` samples."""
    share = first_counts * second_counts / (first_counts + second_counts) ** 2
    mean = float(min(first.mean(), second.mean()))
    return _stated((first - second) ** 2 * share / _denominator(np.minimum(first, second), mean), 2.0)


def _denominator(level: np.ndarray, mean: float) -> np.ndarray:
    floor = FLOOR * mean**2
    return np.maximum(level, 0.0) ** 2 + (floor if floor > 0.0 else 1.0)


def relative_error(picture: np.ndarray, truth: np.ndarray) -> float:
    """The actual error in the same measure: ``picture`` and ``truth`` are luminances of one shape."""
    return float(np.mean((picture - truth) ** 2 / _denominator(truth, float(truth.mean())))) ** 0.5
