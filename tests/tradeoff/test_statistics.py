"""Bias² and variance apart: unbiased, and inside their intervals as often as said."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from lumiere.tradeoff import metrics
from lumiere.tradeoff.statistics import Reference, bias_and_variance, slope, t_quantile

SEEDS, SHAPE, TRIALS = 16, (6, 6, 3), 400


def _trials(bias: float, seed: int) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Estimates of bias² and variance with their half widths, (trials, 2) each, and the true values."""
    random = np.random.default_rng(seed)
    truth = random.uniform(0.2, 2.0, SHAPE)
    sigma = random.uniform(0.1, 0.5, SHAPE)
    weight = np.ones(SHAPE)
    values, widths = [], []
    for _ in range(TRIALS):
        replicates = truth + 0.2 * sigma * random.standard_normal((SEEDS, *SHAPE))
        reference = Reference(replicates.mean(axis=0), replicates.var(axis=0, ddof=1) / SEEDS, replicates)
        pictures = truth + bias + sigma * random.standard_normal((SEEDS, *SHAPE))
        estimates = bias_and_variance(pictures, reference, weight)
        values.append([e.value for e in estimates])
        widths.append([e.half_width for e in estimates])
    return np.array(values), np.array(widths), bias**2, float((sigma**2).mean())


@pytest.mark.parametrize("bias", [0.0, 0.02, 0.2])
def test_estimates_are_unbiased_and_intervals_hold(bias: float) -> None:
    values, widths, bias2, variance = _trials(bias, seed=11)
    for column, true in ((0, bias2), (1, variance)):
        z = (values[:, column].mean() - true) / (values[:, column].std(ddof=1) / TRIALS**0.5)
        assert abs(z) < stats.norm.isf(0.5e-4)
        held = np.count_nonzero(np.abs(values[:, column] - true) <= widths[:, column])
        # 93 % or more, as far as this many trials can tell: the jackknife's interval is 95 % for many seeds.
        assert stats.binom.cdf(held, TRIALS, 0.93) > 1e-4


def test_the_mean_of_seeds_alone_would_show_a_bias_where_there_is_none() -> None:
    values, _, _, variance = _trials(0.0, seed=12)
    assert values[:, 0].mean() + variance / SEEDS > 10 * abs(values[:, 0].mean())


def test_rel_mse_of_a_relative_offset() -> None:
    reference = np.random.default_rng(1).uniform(1.0, 2.0, (20, 20, 3))
    floor = metrics.FLOOR * reference.mean() ** 2
    expected = np.mean((0.1 * reference) ** 2 / (reference**2 + floor))
    assert metrics.rel_mse(1.1 * reference, reference) == pytest.approx(expected)


def test_rel_mse_does_not_depend_on_the_unit() -> None:
    random = np.random.default_rng(2)
    reference = random.uniform(0.0, 2.0, (8, 8, 3))
    picture = reference + 0.1 * random.standard_normal((8, 8, 3))
    assert metrics.rel_mse(1e6 * picture, 1e6 * reference) == pytest.approx(metrics.rel_mse(picture, reference))


def test_trimming_drops_a_firefly() -> None:
    reference = np.ones((40, 40, 3))
    picture = reference + 0.1
    picture[3, 3] = 1000.0
    assert metrics.rel_mse(picture, reference) > 100.0
    assert metrics.rel_mse(picture, reference, metrics.TRIMMED) == pytest.approx(0.01 / 1.01)


def test_flip_tells_a_picture_from_itself_by_nothing_and_from_another_by_more_the_further_it_is() -> None:
    pytest.importorskip("flip_evaluator", reason="FLIP is an extra")
    reference = np.random.default_rng(3).uniform(0.0, 2.0, (32, 32, 3))
    near, far = metrics.flip(reference * 1.1, reference), metrics.flip(reference * 2.0, reference)
    assert metrics.flip(reference, reference) == 0.0
    assert near is not None and far is not None and 0.0 < near < far <= 1.0


@pytest.mark.parametrize("degrees", [3, 7, 15, 100])
def test_t_quantile(degrees: int) -> None:
    assert t_quantile(degrees) == pytest.approx(stats.t.ppf(0.975, degrees), rel=0.01)


def test_slope_of_monte_carlo_is_minus_a_half() -> None:
    seconds = [1.0, 2.0, 8.0]
    assert slope(seconds, [3.0 * t**-0.5 for t in seconds]) == pytest.approx(-0.5)
    assert slope([1.0, 1.0], [1.0, 2.0]) is None
