"""Bias² and variance apart, from pictures of independent seeds against a reference that is noisy itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Estimate:
    """A number and the half width of its 95 % interval."""

    value: float
    half_width: float

    @property
    def interval(self) -> tuple[float, float]:
        """Both ends."""
        return self.value - self.half_width, self.value + self.half_width

    @property
    def differs_from_zero(self) -> bool:
        """0 is outside the interval."""
        return abs(self.value) > self.half_width


@dataclass(frozen=True)
class Reference:
    """``mean`` (h, w, 3) is what pictures are measured against, ``variance`` that of each of its values; ``replicates`` (n, h, w, 3) are the
    independent pictures that it is the mean of, None where it came from a file."""

    mean: np.ndarray
    variance: np.ndarray
    replicates: np.ndarray | None = None


def t_quantile(degrees: int) -> float:
    """97.5 % point of Student's t for at least 3 degrees of freedom, to 1 % (Abramowitz & Stegun 1964, 26.7.5)."""
    z = 1.959964
    terms = (z, (z**3 + z) / 4, (5 * z**5 + 16 * z**3 + 3 * z) / 96, (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384,
             (79 * z**9 + 776 * z**7 + 1482 * z**5 - 1920 * z**3 - 945 * z) / 92160)
    return float(sum(term / degrees**power for power, term in enumerate(terms)))


def _jackknife(values: np.ndarray) -> float:
    """Variance of the statistic whose leave-one-out ``values`` these are (Efron & Stein 1981)."""
    return float((len(values) - 1) / len(values) * np.sum((values - values.mean()) ** 2))


def bias_and_variance(pictures: np.ndarray, reference: Reference, weight: np.ndarray) -> tuple[Estimate, Estimate]:
    """Bias² of the expected picture and variance of one picture, each the mean over values of ``weight`` (h, w, 3) times it.

    ``pictures`` (n, h, w, 3), n ≥ 4, come from independent seeds. (mean − R)² exceeds bias² by the variance of the mean and by that of the
    reference, so both are taken off: the estimate is unbiased and may be below 0. Intervals: the jackknife over the seeds, and over the
    reference's replicates where there are any; where the bias is 0 the jackknife of this degenerate U-statistic is up to √2 too wide.
    """
    n = len(pictures)
    flat = pictures.reshape(n, -1).astype(np.float64)
    w = weight.ravel() / weight.size
    base = reference.mean.ravel().astype(np.float64)
    reference_variance = reference.variance.ravel()
    total, squares = (flat - base).sum(axis=0), ((flat - base) ** 2).sum(axis=0)

    def both(count: int, total: np.ndarray, squares: np.ndarray) -> tuple[float, float]:
        mean = total / count
        variance = np.maximum(squares - count * mean**2, 0.0) / (count - 1)
        return float(w @ (mean**2 - variance / count - reference_variance)), float(w @ variance)

    bias, variance = both(n, total, squares)
    left_out = np.array([both(n - 1, total - (x - base), squares - (x - base) ** 2) for x in flat])
    bias_error2, variance_error2 = _jackknife(left_out[:, 0]), _jackknife(left_out[:, 1])
    if reference.replicates is not None:
        bias_error2 += _reference_share(total / n, reference, w)
    t = t_quantile(n - 1)
    return Estimate(bias, t * bias_error2**0.5), Estimate(variance, t * variance_error2**0.5)


def _reference_share(difference: np.ndarray, reference: Reference, w: np.ndarray) -> float:
    """Variance that the reference's noise gives to bias²; ``difference`` is mean picture − reference."""
    replicates = reference.replicates.reshape(len(reference.replicates), -1).astype(np.float64)
    m = len(replicates)
    base = reference.mean.ravel()
    total, squares = (replicates - base).sum(axis=0), ((replicates - base) ** 2).sum(axis=0)
    left_out = []
    for x in replicates - base:
        mean = (total - x) / (m - 1)
        variance = np.maximum(squares - x**2 - (m - 1) * mean**2, 0.0) / (m - 2)
        left_out.append(float(w @ ((difference - mean) ** 2 - variance / (m - 1))))
    return _jackknife(np.array(left_out))


def slope(seconds: list[float], errors: list[float]) -> float | None:
    """Least-squares slope of log error against log time; None for fewer than two times."""
    if len(set(seconds)) < 2 or min(errors) <= 0.0 or min(seconds) <= 0.0:
        return None
    return float(np.polyfit(np.log(seconds), np.log(errors), 1)[0])
