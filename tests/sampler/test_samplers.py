"""The random numbers of each sampler, as the device makes them: uniform, stratified where they say so, and independent where they must be."""

from __future__ import annotations

from functools import cache
from itertools import combinations, product

import numpy as np
import pyopencl as cl
import pytest
from scipy import stats

from tests.render.probe import Probe
from tests.statistics import chi_square, sidak

Array = np.ndarray

SAMPLERS = ("independent", "sobol", "stratified")
DIMENSIONS = (0, 3, 8, 9, 11, 12, 16, 17, 19, 24, 139)
"""Lens, film, and some of a path's first, second, third and seventeenth vertex: modulo 8, 0 is a light and 3 a direction."""

KERNEL = """
    uint first = 4u * item;
    sequence_t sequence;
    sequence.seed = hash_combine(hash_combine(scene.render->seed, in_uints[first]), in_uints[first + 1u]);
    sequence.index = in_uints[first + 2u];
#ifdef SAMPLER_STRATA
    sequence.strata_x = scene.render->strata_x;
    sequence.strata_y = scene.render->strata_y;
#endif
    pair_t pair = sample_2d(&sequence, in_uints[first + 3u]);
    out_uints[3u * item] = sample_1d(&sequence, in_uints[first + 3u]);
    out_uints[3u * item + 1u] = pair.x;
    out_uints[3u * item + 2u] = pair.y;
"""


@cache
def sampler_probe(device: cl.Device, kind: str, spp: int = 64) -> Probe:
    return Probe(device, {"scene": {"sampler": {"type": kind, "spp": spp}}}, "generate", KERNEL)


def numbers(device: cl.Device, kind: str, x: Array | int, y: Array | int, index: Array | int, dimension: Array | int, spp: int = 64) -> Array:
    """(n, 3) float64 in [0, 1): the one-dimensional number, and the pair."""
    wanted = np.stack([np.ravel(a) for a in np.broadcast_arrays(x, y, index, dimension)], axis=1).astype(np.uint32)
    _, bits = sampler_probe(device, kind, spp)(len(wanted), uints=wanted, out_uints=3)
    return bits.astype(np.float64) * 2.0**-32


PIXELS = np.stack(np.meshgrid(np.arange(160), np.arange(160), indexing="ij"), -1).reshape(-1, 2)


def in_cells(*coordinates: Array, cells: int) -> Array:
    """How many points each cell of a grid holds."""
    index = np.zeros(len(coordinates[0]), np.int64)
    for coordinate in coordinates:
        index = index * cells + np.minimum((coordinate * cells).astype(np.int64), cells - 1)
    return np.bincount(index, minlength=cells ** len(coordinates)).astype(np.float64)


def evenly(counts: Array) -> float:
    """p-value of the χ² test that all cells are equally likely."""
    return chi_square(counts, np.full(counts.size, counts.sum() / counts.size))


@pytest.mark.parametrize("kind", SAMPLERS)
def test_numbers_are_uniform_over_pixels(device: cl.Device, kind: str) -> None:
    """One sample of one dimension takes all values equally often over the pixels: in one dimension, and in two."""
    levels = []
    for dimension in DIMENSIONS:
        for index in (0, 5, 63):
            u = numbers(device, kind, PIXELS[:, 0], PIXELS[:, 1], index, dimension)
            levels += [evenly(in_cells(u[:, i], cells=256)) for i in range(3)] + [evenly(in_cells(u[:, 1], u[:, 2], cells=16))]
    assert min(levels) > sidak(1e-3, len(levels))
    # Numbers that lie too evenly are no more random than those that lie unevenly: Sobol's must be scrambled a pixel.
    assert max(levels) < 1.0 - sidak(1e-3, len(levels))


@pytest.mark.parametrize("kind", SAMPLERS)
def test_dimensions_are_independent(device: cl.Device, kind: str) -> None:
    """No two dimensions of one sample know of each other, over the pixels."""
    u = {d: numbers(device, kind, PIXELS[:, 0], PIXELS[:, 1], 7, d) for d in DIMENSIONS}
    levels = [evenly(in_cells(u[a][:, i], u[b][:, j], cells=16)) for a, b in combinations(DIMENSIONS, 2) for i, j in ((0, 1), (1, 1), (2, 1))]
    assert min(levels) > sidak(1e-3, len(levels))


@pytest.mark.parametrize("kind", SAMPLERS)
def test_dimensions_of_one_pixel_know_nothing_of_each_other(device: cl.Device, kind: str) -> None:
    """What a padded sampler may get wrong: within a pixel, the samples of two dimensions must fill the square at least as if they were drawn apart.

    The products of the signs of two numbers, about ½ and about ¼ and ¾, must average to 0 over pixels. Orders that keep blocks of 2^k together,
    or jump between few strata, let samples coincide in pairs: the mean over a pixel may vary at most twice as much as that of independent ones.
    (Two lights of a path may share Sobol's order: they are summed, no contribution depends on both.)
    """
    pixels, count = 512, 64
    index, pixel = np.tile(np.arange(count), pixels), np.repeat(np.arange(pixels), count)
    u = {d: numbers(device, kind, pixel, pixel // 7, index, d).reshape(pixels, count, 3) for d in DIMENSIONS}
    z, spread = [], []
    for a, b in combinations(DIMENSIONS, 2):
        both_lights = kind == "sobol" and 0 < a and a % 8 == b % 8 == 0
        for i, j in ((0, 0),) if both_lights else ((0, 0), (1, 1), (2, 1)):
            for cells in (1, 2):
                signs = np.sign((cells * u[a][..., i]) % 1.0 - 0.5) * np.sign((cells * u[b][..., j]) % 1.0 - 0.5)
                means = signs.mean(axis=1)
                z.append(means.mean() * np.sqrt(pixels) / max(means.std(ddof=1), 1e-9))  # 0 where each pixel's samples are balanced
                spread.append(np.square(means).mean() * count)
    level = sidak(1e-3, len(z))
    assert np.abs(z).max() < stats.t.isf(level / 2.0, pixels - 1)
    assert max(spread) < 2.0 * stats.chi2.isf(level, pixels) / pixels


@pytest.mark.parametrize("kind", SAMPLERS)
def test_neighbouring_pixels_are_independent(device: cl.Device, kind: str) -> None:
    levels = []
    for dx, dy in ((1, 0), (0, 1), (1, 1), (8, 0)):
        for dimension in (3, 8, 11):
            u = numbers(device, kind, PIXELS[:, 0], PIXELS[:, 1], 3, dimension)
            v = numbers(device, kind, PIXELS[:, 0] + dx, PIXELS[:, 1] + dy, 3, dimension)
            levels += [evenly(in_cells(u[:, i], v[:, i], cells=16)) for i in range(3)]
    assert min(levels) > sidak(1e-3, len(levels))


@pytest.mark.parametrize("kind", SAMPLERS)
def test_seed_changes_the_numbers(device: cl.Device, kind: str) -> None:
    scene = {"scene": {"sampler": {"type": kind, "seed": 1}}}
    wanted = np.stack([np.arange(256), np.zeros(256), np.zeros(256), np.full(256, 8)], axis=1).astype(np.uint32)
    _, other = Probe(device, scene, "generate", KERNEL)(256, uints=wanted, out_uints=3)
    _, first = sampler_probe(device, kind)(256, uints=wanted, out_uints=3)
    assert np.count_nonzero(other == first) <= 1


@pytest.mark.parametrize("log_count", [0, 1, 2, 3, 4, 6, 9])
def test_sobol_fills_every_elementary_interval(device: cl.Device, log_count: int) -> None:
    """Each 2^k consecutive samples from a multiple of 2^k put one point in every 2^-a × 2^(a−k) box, in every pair of dimensions (Sobol 1967)."""
    count = 1 << log_count
    for dimension in DIMENSIONS:
        for block in (0, 3):
            u = numbers(device, "sobol", 11, 4, np.arange(count) + block * count, dimension)
            for a in range(log_count + 1):
                columns, rows = 1 << a, 1 << (log_count - a)
                cell = np.floor(u[:, 1] * columns) * rows + np.floor(u[:, 2] * rows)
                assert len(np.unique(cell)) == count, f"dimension {dimension}, samples from {block * count}, {columns} × {rows} boxes"
            assert len(np.unique(np.floor(u[:, 0] * count))) == count


@pytest.mark.parametrize(("log_count", "t"), [(4, 2), (6, 2), (8, 4)])
@pytest.mark.parametrize("links", [(3, 8), (3, 11), (3, 16), (11, 16), (19, 24), (19, 27), (19, 32), (27, 32), (139, 144)])
def test_sobol_fills_boxes_of_two_pairs(device: cl.Device, links: tuple[int, int], log_count: int, t: int) -> None:
    """What goes together on a path, two directions in a row, and the light where each has led, is a (t, k, 4)-net: each 2^k samples put 2^t points
    in every box of volume 2^(t − k) with sides of powers of two. (Orders of their own would leave some empty.)"""
    count, boxes = 1 << log_count, 1 << (log_count - t)
    for block in (0, 5):
        first, second = (numbers(device, "sobol", 3, 8, np.arange(count) + block * count, dimension) for dimension in links)
        u = np.concatenate([first[:, 1:], second[:, 1:]], axis=1)
        for sides in product(range(log_count - t + 1), repeat=4):
            if sum(sides) != log_count - t:
                continue
            cell = np.zeros(count, np.int64)
            for side, coordinate in zip(sides, u.T, strict=True):
                cell = (cell << side) + np.floor(coordinate * (1 << side)).astype(np.int64)
            assert np.all(np.bincount(cell, minlength=boxes) == 1 << t), f"samples from {block * count}, boxes of 2^-{sides}"


@pytest.mark.parametrize("spp", [1, 2, 7, 16, 60, 64, 101])
def test_stratified_fills_every_stratum(device: cl.Device, spp: int) -> None:
    """As many strata as samples, or a few more: no stratum is visited twice, and the order differs between dimensions."""
    render = sampler_probe(device, "stratified", spp).buffers.arrays["render"][1]
    columns, rows = int(render["strata_x"][0]), int(render["strata_y"][0])
    assert columns * rows >= spp > columns * rows - columns
    orders = []
    for dimension in DIMENSIONS:
        u = numbers(device, "stratified", 2, 9, np.arange(spp), dimension, spp=spp)
        cell = np.floor(u[:, 1] * columns) * rows + np.floor(u[:, 2] * rows)
        assert len(np.unique(cell)) == spp
        assert len(np.unique(np.floor(u[:, 0] * (columns * rows)))) == spp
        orders.append(tuple(cell))
    assert spp < 7 or len(set(orders)) == len(orders)


def test_stratified_jitters_each_stratum_by_itself(device: cl.Device) -> None:
    """Where in their strata a pixel's samples lie: their mean varies over pixels as that of independent numbers, 1 / 12 n."""
    pixels, count = 1024, 64
    index, pixel = np.tile(np.arange(count), pixels), np.repeat(np.arange(pixels), count)
    for dimension in DIMENSIONS:
        u = numbers(device, "stratified", pixel, pixel // 7, index, dimension).reshape(pixels, count, 3)
        places = (u * (64.0, 8.0, 8.0)) % 1.0
        spread = 12.0 * count * np.square(places.mean(axis=1) - 0.5).sum(axis=0)
        level = sidak(1e-3, 3 * len(DIMENSIONS))
        assert np.all(spread < stats.chi2.isf(level / 2.0, pixels)) and np.all(spread > stats.chi2.ppf(level / 2.0, pixels))


PERMUTE = """
    uint first = 3u * item;
    out_uints[item] = permute(in_uints[first], in_uints[first + 1u], in_uints[first + 2u]);
"""


@pytest.mark.parametrize("length", [1, 2, 3, 5, 8, 37, 64, 1000, 4097])
def test_permute_is_a_permutation(device: cl.Device, length: int) -> None:
    probe = Probe(device, {"scene": {"sampler": {"type": "stratified"}}}, "generate", PERMUTE)
    seen = set()
    for seed in (0, 1, 0x9E3779B9, 0xFFFFFFFF):
        wanted = np.stack([np.arange(length), np.full(length, length), np.full(length, seed)], axis=1)
        _, out = probe(length, uints=wanted, out_uints=1)
        assert np.array_equal(np.sort(out[:, 0]), np.arange(length))
        seen.add(tuple(out[:, 0]))
    assert length < 5 or len(seen) == 4


@pytest.mark.parametrize("length", [3, 4, 37, 64])
def test_permute_takes_each_element_anywhere(device: cl.Device, length: int) -> None:
    """Over seeds that are hashes, as the sampler's, every element comes to every place equally often."""
    probe = Probe(device, {"scene": {"sampler": {"type": "stratified"}}}, "generate",
                  PERMUTE.replace("in_uints[first + 2u]", "hash_uint(in_uints[first + 2u])"))
    seeds = 20000
    levels = []
    for place in range(min(length, 8)):
        wanted = np.stack([np.full(seeds, place), np.full(seeds, length), np.arange(seeds)], axis=1)
        _, out = probe(seeds, uints=wanted, out_uints=1)
        levels.append(evenly(np.bincount(out[:, 0], minlength=length).astype(np.float64)))
    assert min(levels) > sidak(1e-3, len(levels))
