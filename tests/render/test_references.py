"""Reference scenes against converged pictures of other renderers: does noise explain every difference?

Block by block and over the whole picture, the difference is divided by its standard deviation (tools/compare.py). What is asked of z is what chance
allows of normal numbers of variance 1 or less: Sobol points make less noise than their own scatter says. The same checks must reject a picture
that is a little wrong; that is tested too.

All are rendered without energy compensation, as the renderers of the references do (tools/references.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest
from scipy import stats

import lumiere
from lumiere.errors import SceneError
from tests.render.scenes import index_of
from tests.statistics import sidak
from tools.compare import Comparison, block_means, compare, read, variance_of_difference
from tools.references import load

OWN = Path(__file__).parent.parent / "refs"
SHARED = Path(__file__).parents[3] / "shared" / "refs"
"""Further references, whose assets are not part of the repository."""

ASSETS = {"cow_in_sun"}
NAMES = sorted({path.stem for folder in (OWN, SHARED) for path in folder.glob("*.json")} | ASSETS)

SAMPLES = {"delta_lights": 64, "lens": 64, "shapes_as_lights": 64}
"""Samples a pixel, else 32: what two cores do in a few seconds."""

SIGNIFICANCE = 1e-4
"""Of all checks of one scene together."""


@dataclass
class Measured:
    pixels: np.ndarray
    reference: np.ndarray
    variance: np.ndarray
    """Of their difference."""
    moved: np.ndarray
    """(h, w) bool: pixels with noise, whose light has bounced."""


@cache
def measure(device: cl.Device, name: str) -> Measured:
    """Renders the scene; skips with a reason where it is not here, or not yet to be rendered."""
    folder = OWN if (OWN / f"{name}.json").exists() else SHARED
    if not (folder / f"{name}.json").exists():
        pytest.skip(f"{name} needs assets that are not part of the repository: {SHARED} is not here")
    try:
        scene = load(folder / f"{name}.json")
    except SceneError as error:
        if "not supported yet" in str(error):
            pytest.skip(str(error)[str(error).index("not supported yet"):])
        raise
    image = lumiere.render(scene, spp=SAMPLES.get(name, 32), device=index_of(device))
    reference, reference_spp = read(folder / f"{name}.exr")
    stderr = read(folder / f"{name}.stderr.exr")[0][""]
    variance = variance_of_difference(image.variance.astype(np.float64), image.record["spp"], stderr, reference_spp)
    assert image.record["non_finite"]["count"] == 0
    return Measured(image.pixels.astype(np.float64), reference[""], variance, stderr.max(axis=-1) > 0.0)


def complaints(c: Comparison) -> list[str]:
    """What chance does not explain. Each check has an equal share of SIGNIFICANCE."""
    channels = c.z_blocks.shape[2]
    blocks = c.z_blocks.shape[0] * c.z_blocks.shape[1]
    level = sidak(SIGNIFICANCE, 6)
    found = []
    z_limit = stats.norm.isf(sidak(level, channels) / 2.0)
    if np.abs(c.z_mean).max() > z_limit:
        found.append(f"z of the mean {c.z_mean} is beyond {z_limit:.2f}")
    squares, limit = np.square(c.z_blocks).sum(axis=(0, 1)).max(), stats.chi2.isf(sidak(level, channels), blocks)
    if squares > limit:
        found.append(f"sum of z² over {blocks} blocks is {squares:.0f}, beyond {limit:.0f}")
    for z in (3, 4, 5):
        beyond, most = np.sum(np.abs(c.z_blocks) > z, axis=(0, 1)).max(), stats.binom.isf(sidak(level, channels), blocks, 2.0 * stats.norm.sf(z))
        if beyond > most:
            found.append(f"{beyond} of {blocks} blocks have |z| > {z}, more than {most:.0f}")
    largest, limit = np.abs(c.z_blocks).max(), stats.norm.isf(sidak(level, channels * blocks) / 2.0)
    if largest > limit:
        found.append(f"the largest |z| {largest:.2f} is beyond {limit:.2f}")
    return found


@pytest.mark.parametrize("name", NAMES)
def test_agrees_with_the_reference(device: cl.Device, name: str) -> None:
    m = measure(device, name)
    c = compare(m.pixels, m.reference, m.variance)
    assert not complaints(c)
    # Half a per cent, where that is more than three standard deviations.
    deviation = np.sqrt(m.variance.mean(axis=(0, 1)) / m.variance[..., 0].size) / c.mean_b
    assert np.all((np.abs(c.relative) < 0.005) | (3.0 * deviation > 0.005)), f"{100.0 * c.relative} %, z {c.z_mean}"


WRONG = {
    "2 % less light bounces": lambda m: np.where(m.moved[..., None], 0.98 * m.pixels, m.pixels),
    "a pixel to the right": lambda m: np.roll(m.pixels, 1, axis=1),
    "a pixel down": lambda m: np.roll(m.pixels, 1, axis=0),
    "a block a quarter too bright": lambda m: m.pixels * (1.0 + 0.25 * _one_block(m)),
}


def _one_block(m: Measured) -> np.ndarray:
    """(h, w, 1): 1 in the 8 × 8 block that is brightest for its noise, where there is noise."""
    means, noise = block_means(m.pixels, 8)[..., 1], block_means(m.variance, 8)[..., 1]
    noisy = block_means(m.moved[..., None].astype(float), 8)[..., 0] == 1.0
    y, x = np.unravel_index(np.argmax(np.where(noisy, means / np.sqrt(noise + 1e-12), 0.0)), means.shape)
    chosen = np.zeros((*m.pixels.shape[:2], 1))
    chosen[8 * y:8 * y + 8, 8 * x:8 * x + 8] = 1.0
    return chosen


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("name", NAMES)
def test_would_see_a_wrong_picture(device: cl.Device, name: str, wrong: str) -> None:
    """The checks above, fed with pictures that are wrong: else they would prove nothing."""
    m = measure(device, name)
    assert complaints(compare(WRONG[wrong](m), m.reference, m.variance))
