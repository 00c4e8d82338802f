"""The stated error against the true one, on made-up samples."""

from __future__ import annotations

import numpy as np
from scipy import stats

from lumiere.goal.error import error_of_blocks, error_of_halves, relative_error

PIXELS, TRIALS = 300, 300


def _truth(random: np.random.Generator) -> np.ndarray:
    return random.uniform(0.5, 2.0, PIXELS)


def test_the_mean_stated_square_is_the_true_one() -> None:
    random = np.random.default_rng(1)
    truth = _truth(random)
    sigma = 0.05 * truth
    stated, true = [], []
    for _ in range(TRIALS):
        blocks = truth + 4.0 * sigma * random.standard_normal((16, PIXELS))
        stated.append(error_of_blocks(blocks).image ** 2)
        true.append(relative_error(blocks.mean(axis=0), truth) ** 2)
    difference = np.array(stated) - np.array(true)
    # The median in the denominator lies a little off the mean: up to 3 % of the squares.
    assert abs(difference.mean()) < 0.03 * np.mean(true) + 4.0 * difference.std() / TRIALS**0.5


def test_the_bound_holds_for_few_pixels_and_for_many() -> None:
    random = np.random.default_rng(2)
    for pixels, blocks in ((1, 8), (1, 16), (4, 8), (300, 8), (300, 2)):
        held = 0
        for _ in range(TRIALS):
            samples = 1.0 + 0.1 * random.standard_normal((blocks, pixels))
            n = np.ones(pixels)
            error = error_of_blocks(samples) if blocks > 2 else error_of_halves(samples[0], samples[1], n, n)
            held += relative_error(samples.mean(axis=0), np.ones(pixels)) <= error.bound
        assert stats.binom.cdf(held, TRIALS, 0.95) > 1e-3, (pixels, blocks, held)


def test_a_bright_sample_does_not_make_its_own_error_small() -> None:
    blocks = np.ones((16, PIXELS))
    blocks[3, 7] = 1000.0
    # The pixel's mean is 63 off, 62 times what it should be.
    assert error_of_blocks(blocks).pixels[7] > 50.0
    first, second = np.ones(PIXELS), np.ones(PIXELS)
    second[7] = 125.0
    assert error_of_halves(first, second, np.full(PIXELS, 8.0), np.full(PIXELS, 8.0)).pixels[7] > 50.0


def test_black_pictures_have_no_error() -> None:
    assert error_of_blocks(np.zeros((8, 4))).bound == 0.0
