"""The tone maps and the 8-bit encoding, against their published points and properties."""

from __future__ import annotations

import numpy as np
import pytest

from lumiere.errors import UsageError
from lumiere.film.encode import encode8, srgb_encode
from lumiere.film.tonemap import TONEMAPS, aces, agx, filmic

GREYS = np.concatenate([[0.0], np.logspace(-6.0, 6.0, 4001)])[:, None] * np.ones(3)


@pytest.mark.parametrize("name", TONEMAPS)
def test_black_is_black_white_is_bounded_and_grey_rises(name: str) -> None:
    mapped = TONEMAPS[name](GREYS)
    assert np.all(mapped[0] == 0.0)
    assert mapped.min() >= 0.0 and mapped.max() <= 1.0
    assert np.all(np.diff(mapped, axis=0) >= 0.0)
    assert mapped[-1].min() > 0.9


@pytest.mark.parametrize("name", TONEMAPS)
def test_grey_stays_grey(name: str) -> None:
    mapped = TONEMAPS[name](GREYS)
    # The published matrices are given to five digits, so a grey's channels differ by at most their rows' rounding.
    assert np.ptp(mapped, axis=1).max() < 2e-3


@pytest.mark.parametrize("name", TONEMAPS)
def test_out_of_gamut_values_stay_in_range(name: str) -> None:
    rgb = np.random.default_rng(1).normal(0.0, 5.0, (1000, 3))
    mapped = TONEMAPS[name](rgb)
    assert np.all(np.isfinite(mapped)) and mapped.min() >= 0.0 and mapped.max() <= 1.0


def test_filmic_reaches_white_at_half_its_linear_white() -> None:
    np.testing.assert_allclose(filmic(np.full(3, 11.2 / 2.0)), 1.0, atol=1e-12)


def test_aces_of_middle_grey_is_the_fit_by_hand() -> None:
    # With rows that sum to 1 a grey passes both matrices unchanged: (x² + 0.0245786 x − 0.000090537) / (0.983729 x² + 0.432951 x + 0.238081).
    expected = (0.0324 + 0.004424148 - 0.000090537) / (0.0318728196 + 0.07793118 + 0.238081)
    np.testing.assert_allclose(aces(np.full(3, 0.18)), expected, atol=2e-5)


def test_agx_middle_grey_is_the_sigmoids_value() -> None:
    # log2(0.18) = −2.473931 lies at (12.47393 − 2.473931) / 16.499999 = 0.606061 of AgX's range, where the polynomial is taken.
    x = (np.log2(0.18) + 12.47393) / (4.026069 + 12.47393)
    sigmoid = 15.5 * x**6 - 40.14 * x**5 + 31.96 * x**4 - 6.868 * x**3 + 0.4298 * x**2 + 0.1191 * x - 0.00232
    # The rows of the published inset and outset sum to 1 within 7e-5, which the sigmoid's slope and the power make 3e-4.
    np.testing.assert_allclose(agx(np.full(3, 0.18)), sigmoid**2.2, rtol=3e-4)


def test_srgb_encoding_is_the_standards() -> None:
    np.testing.assert_allclose(srgb_encode(np.array([0.0, 0.0031308, 0.5, 1.0])), [0.0, 12.92 * 0.0031308, 0.7353569830524495, 1.0], atol=1e-12)
    x = np.array([0.0031308])
    assert abs(srgb_encode(x)[0] - srgb_encode(np.nextafter(x, 1.0))[0]) < 1e-7, "the two pieces meet"


def test_every_8bit_value_survives_decoding_and_encoding() -> None:
    codes = np.arange(256)
    x = codes / 255.0
    linear = np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)
    np.testing.assert_array_equal(encode8(np.repeat(linear[:, None], 3, axis=1))[:, 0], codes)


def test_rounding_is_to_the_nearest_code() -> None:
    halfway = np.array([9.49, 9.51]) / 255.0 / 12.92  # codes up to 10 lie on the linear piece
    np.testing.assert_array_equal(encode8(halfway[:, None] * np.ones(3))[:, 0], [9, 10])


def test_exposure_is_in_stops() -> None:
    rgb = np.random.default_rng(2).random((50, 3)) / 8.0
    np.testing.assert_array_equal(encode8(rgb, exposure=3.0), encode8(rgb * 8.0))


@pytest.mark.parametrize("name", TONEMAPS)
def test_infinities_are_white_and_nan_is_black(name: str) -> None:
    rgb = np.array([[np.inf] * 3, [np.nan] * 3, [-np.inf] * 3, [3e38] * 3])
    np.testing.assert_array_equal(encode8(rgb, 10.0, name)[:, 1] > 240, [True, False, False, True])
    np.testing.assert_array_equal(encode8(rgb, 10.0, name)[1:3], 0)


def test_an_unknown_tone_map_is_named_with_the_known_ones() -> None:
    with pytest.raises(UsageError, match=r"unknown tone map 'reinhard', expected one of none, aces, agx, filmic"):
        encode8(np.zeros((1, 3)), tonemap="reinhard")
