"""Integer CDFs: whatever the weights, every 32-bit number draws exactly one entry, each about as often as its weight says."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lumiere.light.distribution import ONE, distribution_2d, integer_cdf
from tests.render.probe import Probe

weights_of = st.one_of(st.just(0.0), st.floats(0.0, 1e300, allow_subnormal=True), st.floats(0.0, 1.0))


def widths(cdf: np.ndarray) -> np.ndarray:
    """How many of the 2³² numbers draw each entry, as cl/lib/discrete.cl reads the table."""
    return np.diff(cdf.astype(np.int64), prepend=-1)


@settings(max_examples=300, deadline=None)
@given(arrays(np.float64, st.integers(1, 200), elements=weights_of))
def test_integer_cdf_shares_all_numbers_out(weights: np.ndarray) -> None:
    n = len(weights)
    units = widths(integer_cdf(weights))
    assert units.sum() == ONE
    assert units.min() >= 0
    assert np.all(units[weights > 0.0] > 0)
    assert np.all(units[1:][weights[1:] == 0.0] <= (0 if weights.any() else ONE))
    # Each weight above 0 is given one unit, and what rounding leaves over goes to the largest: so much may be missing elsewhere.
    if weights.any():
        expected = weights / weights.max()  # the largest is 1
        expected *= ONE / expected.sum()
        assert np.abs(units - expected).max() <= n + 2


@settings(max_examples=50, deadline=None)
@given(arrays(np.float64, st.tuples(st.integers(1, 12), st.integers(1, 12)), elements=weights_of))
def test_distribution_2d_draws_by_weight(weights: np.ndarray) -> None:
    with np.errstate(over="ignore"):
        rows, columns = distribution_2d(weights / max(weights.max(), 1.0))
    height, width = weights.shape
    assert len(rows) == height and len(columns) == height * width
    assert widths(rows).sum() == ONE
    assert np.all(widths(columns.reshape(height, width)).sum(axis=1) == ONE)


def test_all_weights_zero_is_uniform() -> None:
    units = widths(integer_cdf(np.zeros(7)))
    assert units.max() - units.min() <= 7


PROBE = """
    discrete_t d = discrete_sample(scene.environment_rows, in_uints[0], in_uints[1u + item]);
    out_uints[2u * item] = d.index;
    out_uints[2u * item + 1u] = d.rest;
    out_floats[2u * item] = d.probability;
    out_floats[2u * item + 1u] = discrete_probability(scene.environment_rows, item % in_uints[0]);
"""


@pytest.mark.parametrize("weights", [[1.0], [0.0, 1.0], [1.0, 0.0], [0.0, 0.0, 3.0, 0.0, 1e-12, 2.0, 0.0], [0.0, 1e-30, 1.0], [1.0] * 13],
                         ids=lambda w: f"{len(w)} entries")
def test_device_draws_what_the_table_says(device: cl.Device, weights: list[float], sky: str) -> None:
    """Every entry is drawn by its own numbers, with the probability that the device gives it; what is left of a number is uniform."""
    cdf = integer_cdf(np.array(weights))
    probe = Probe(device, {"scene": {"geometry": [{"type": "sphere"}], "lights": [{"type": "environment", "file": sky}]}}, "shade", PROBE)
    probe.buffers.arrays["environment_rows"] = ("uint", cdf)
    edges = np.concatenate([cdf, cdf.astype(np.int64) + 1, np.random.default_rng(1).integers(0, ONE, 4096), [0, ONE - 1]])
    u = np.unique(edges[(edges >= 0) & (edges < ONE)]).astype(np.uint32)
    probabilities, drawn = probe(len(u), uints=np.concatenate([[len(cdf)], u]), out_floats=2, out_uints=2)
    assert np.array_equal(drawn[:, 0], np.searchsorted(cdf, u, side="left"))
    exact = widths(cdf) / ONE
    count = min(len(cdf), len(u))
    # One rounding: of the width to a float.
    assert np.allclose(probabilities[:count, 1], exact[:count], rtol=2.0**-23, atol=0.0)
    assert np.allclose(probabilities[:, 0], exact[drawn[:, 0]], rtol=2.0**-23, atol=0.0)
    below = np.concatenate([[-1], cdf.astype(np.int64)])[drawn[:, 0]] + 1
    assert np.allclose(drawn[:, 1] / ONE, (u - below) / widths(cdf)[drawn[:, 0]], atol=2.0**-31)
