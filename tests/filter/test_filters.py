"""Reconstruction filters: what the table draws and weighs is the filter, and a picture is what the filter makes of the scene."""

from __future__ import annotations

from functools import cache

import numpy as np
import pyopencl as cl
import pytest

from lumiere.film.image import Image
from lumiere.filter import FILTERS, TABLE_SIZE, Filter
from tests.render.scenes import assert_exact, assert_mean, from_above, render

Array = np.ndarray

NAMES = list(FILTERS.kinds())
POSITIVE = [name for name in NAMES if name != "mitchell"]
RADII = [None, 0.7, 3.0]


def made(name: str, radius: float | None) -> Filter:
    return FILTERS.get(name)(radius=radius)


def cumulated(filter: Filter, fine: int = 1 << 16) -> tuple[Array, Array]:
    """Points x, and ∫ f up to there over ∫ f, by midpoints."""
    x = np.linspace(-filter.extent, filter.extent, fine + 1)
    f = filter.evaluate((x[1:] + x[:-1]) / 2.0)
    return x, np.concatenate([[0.0], np.cumsum(f)]) / f.sum()


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("name", [n for n in NAMES if n != "box"])
def test_table_is_the_filter(name: str, radius: float | None) -> None:
    """The steps' weights, each a TABLE_SIZE-th of the samples, add up to the filter's integral everywhere that a step ends."""
    filter = made(name, radius)
    steps, weights = filter.table().astype(np.float64).T
    assert len(steps) == TABLE_SIZE + 1
    assert np.all(np.diff(steps) > 0.0) and np.all(np.abs(steps) <= filter.extent * (1.0 + 1e-6))
    assert np.allclose(steps, -steps[::-1], atol=1e-3 * filter.extent)
    x, integral = cumulated(filter)
    assert np.allclose(np.cumsum(weights[:-1]) / TABLE_SIZE, np.interp(steps[1:], x, integral), atol=1e-4)
    assert weights[:-1].sum() / TABLE_SIZE == pytest.approx(1.0, abs=1e-6)
    assert np.any(weights < 0.0) == (name == "mitchell")


def test_filters_are_their_formulas() -> None:
    """Values at a few places, by the formulas of their sources."""
    at = np.array([0.0, 0.5, 1.0])
    assert np.allclose(made("tent", 1.0).evaluate(at), [1.0, 0.5, 0.0])
    assert np.allclose(made("mitchell", 2.0).evaluate(np.array([0.0, 1.0, 1.5, 2.0])) / (16.0 / 18.0), [1.0, 1.0 / 16.0, -(1.75 / 6.0) / 7.0, 0.0], atol=1e-2)
    gaussian = made("gaussian", 1.5).evaluate(np.array([0.0, 0.5, 1.5]))
    assert np.allclose(gaussian, [1.0 - np.exp(-4.5), np.exp(-0.5) - np.exp(-4.5), 0.0])
    harris = made("blackman_harris", 1.5).evaluate(np.array([0.0, 1.5]))
    assert np.allclose(harris, [1.0, 0.00006], atol=1e-9)


PIXELS = 16


@cache
def edge(device: cl.Device, name: str, radius: float | None, span: float, spp: int) -> Image:
    """What shines covers the picture up to ``span`` pixels from its left side."""
    size = float(PIXELS)
    half = (span + size) / 2.0
    lamp = {"type": "rectangle", "emission": 1.0, "transform": [
        {"scale": [half, 2.0 * size, 1.0]}, {"rotate": {"axis": [1, 0, 0], "angle": -90}}, {"translate": [span - half - size / 2.0, 0, 0]}]}
    film = {"width": PIXELS, "height": PIXELS, "filter": {"type": name} | ({} if radius is None else {"radius": radius})}
    return render(device, {"camera": from_above(3.0, size), "film": film, "sampler": {"type": "independent", "spp": spp},
                           "integrator": {"max_depth": 0}, "geometry": [lamp]})


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("name", NAMES)
def test_edge_is_blurred_by_the_filter(device: cl.Device, name: str, radius: float | None) -> None:
    """Each column's value is the filter's integral up to the edge: also the Mitchell filter's overshoot on both sides."""
    filter = made(name, radius)
    x, integral = cumulated(filter)
    span = 7.3
    expected = np.interp(span - (np.arange(PIXELS) + 0.5), x, integral)
    image = edge(device, name, radius, span, 512)
    reach = np.abs(span - (np.arange(PIXELS) + 0.5)) < filter.extent + 1e-4
    columns = np.broadcast_to(expected[None, :, None], image.pixels.shape)
    assert_mean(image, columns, where=np.broadcast_to(reach, (PIXELS, PIXELS)), roundings=1 << 10)
    # One by one, where a thousand samples hold some from both sides.
    for column in np.flatnonzero(reach & (np.minimum(np.abs(expected), np.abs(expected - 1.0)) > 0.01)):
        only = np.zeros((PIXELS, PIXELS), bool)
        only[:, column] = True
        assert_mean(image, columns, where=only, roundings=1 << 10)


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("name", NAMES)
def test_constant_picture_stays_constant(device: cl.Device, name: str, radius: float | None) -> None:
    """Exactly, where a filter has no negative lobes; in the mean where it has."""
    image = edge(device, name, radius, 100.0, 512)
    if name in POSITIVE:
        assert_exact(image.pixels, 1.0)
    else:
        assert_mean(image, np.ones(3))


def test_box_is_the_mean(device: cl.Device) -> None:
    """Half a pixel each way: a pixel that is covered to three tenths has three tenths of the light."""
    image = edge(device, "box", None, 7.3, 512)
    assert_exact(image.pixels[:, :7], 1.0)
    assert not image.pixels[:, 8:].any()
    only = np.zeros((PIXELS, PIXELS), bool)
    only[:, 7] = True
    assert_mean(image, np.full(3, 0.3), where=only)
