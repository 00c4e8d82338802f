"""The builder: what every topology must be, and that its splits are the best there are."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lumiere.accel import build as builder
from lumiere.accel.build import Topology, build, half_area, sah_cost, single_leaf


def check(topology: Topology, lower: np.ndarray, upper: np.ndarray, max_leaf_size: int) -> None:
    """Every primitive in exactly one leaf, every node's box that of what it holds, no leaf too large or too deep."""
    n = len(lower)
    assert np.array_equal(np.sort(topology.order), np.arange(n))
    if n == 0:
        assert len(topology.left) == 0
        return
    lower, upper = lower[topology.order], upper[topology.order]
    leaves_of = np.zeros(n, int)
    visited = np.zeros(len(topology.left), int)
    depth, waiting = 0, [(0, 0)]
    assert (topology.first[0], topology.count[0]) == (0, n)
    while waiting:
        node, level = waiting.pop()
        visited[node] += 1
        depth = max(depth, level)
        first, count, left = int(topology.first[node]), int(topology.count[node]), int(topology.left[node])
        assert np.array_equal(topology.lower[node], lower[first : first + count].min(axis=0))
        assert np.array_equal(topology.upper[node], upper[first : first + count].max(axis=0))
        if left < 0:
            assert 1 <= count <= max_leaf_size
            leaves_of[first : first + count] += 1
        else:
            assert topology.first[left] == first and topology.first[left + 1] == first + topology.count[left]
            assert topology.count[left] + topology.count[left + 1] == count
            waiting += [(left, level + 1), (left + 1, level + 1)]
    assert (leaves_of == 1).all() and (visited == 1).all()
    assert topology.depth == depth <= builder.MAX_DEPTH


coordinates = st.one_of(
    st.integers(-4, 4).map(float),  # ties and duplicates
    st.floats(-1.0, 1.0, width=32),
    st.floats(width=32, allow_nan=False, allow_infinity=False))
boxes = st.lists(st.tuples(*[coordinates] * 6), max_size=60).map(lambda rows: np.array(rows, np.float32).reshape(-1, 2, 3))


@settings(max_examples=200, deadline=None)
@given(boxes, st.sampled_from([1, 2, 4, 8]))
def test_random_boxes(corners: np.ndarray, max_leaf_size: int) -> None:
    lower, upper = corners.min(axis=1), corners.max(axis=1)
    check(build(lower, upper, max_leaf_size), lower, upper, max_leaf_size)


@pytest.mark.parametrize("n", [0, 1, 2, 3, 4, 5])
def test_few(n: int) -> None:
    lower = np.random.default_rng(n).random((n, 3)).astype(np.float32)
    check(build(lower, lower + 1), lower, lower + 1, 4)
    check(single_leaf(lower, lower + 1), lower, lower + 1, 5)


@pytest.mark.parametrize("max_leaf_size", [1, 4])
def test_ten_thousand_identical_boxes_are_halved(max_leaf_size: int) -> None:
    lower = np.full((10_000, 3), 0.25, np.float32)
    topology = build(lower, lower + 1, max_leaf_size)
    check(topology, lower, lower + 1, max_leaf_size)
    assert topology.depth == int(np.ceil(np.log2(10_000 / max_leaf_size)))


@pytest.mark.parametrize("scale", [1e-45, 1e-38, 1e-30, 1.0, 1e30, 3e38])
def test_scales(scale: float) -> None:
    corners = np.random.default_rng(5).uniform(-1, 1, (3000, 2, 3)) * scale
    lower, upper = corners.min(axis=1).astype(np.float32), corners.max(axis=1).astype(np.float32)
    check(build(lower, upper), lower, upper, 4)


def test_flat_boxes_are_split_well() -> None:
    """A flat grid has boxes without volume; a median split of it would cost as much, a single leaf a hundred times more."""
    x, y = np.meshgrid(np.arange(64), np.arange(64))
    lower = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3).astype(np.float32)
    topology = build(lower, lower + np.float32([1, 1, 0]))
    check(topology, lower, lower + np.float32([1, 1, 0]), 4)
    assert sah_cost(topology) < 0.01 * sah_cost(single_leaf(lower, lower + np.float32([1, 1, 0])))


def test_geometric_progressions_stay_within_the_depth() -> None:
    """Clusters 2^k apart, where the best plane parts off the outermost one, time after time."""
    exponents = np.repeat(np.arange(-120, 120), 40)
    lower = np.random.default_rng(7).uniform(0.9, 1.0, (len(exponents), 3)) * 2.0 ** exponents[:, None]
    lower = lower.astype(np.float32)
    topology = build(lower, lower * np.float32(1.001), 1)
    check(topology, lower, lower * np.float32(1.001), 1)
    assert topology.depth > np.log2(len(lower)) + 8, "the case is too easy to tell"


@pytest.mark.parametrize("spare", [0, 1, 3])
def test_the_depth_is_bounded_by_halving(monkeypatch: pytest.MonkeyPatch, spare: int) -> None:
    """With the bound at or little above the depth of a perfectly balanced tree."""
    monkeypatch.setattr(builder, "MAX_DEPTH", 8 + spare)
    lower = (2.0 ** np.linspace(-100, 100, 1024)[:, None] * np.ones(3)).astype(np.float32)
    topology = build(lower, lower, 4)
    check(topology, lower, lower, 4)
    if spare == 0:
        assert (topology.count[topology.leaves] == 4).all()
    with pytest.raises(ValueError, match="found 1025 primitives"):
        monkeypatch.setattr(builder, "MAX_DEPTH", 8)
        build(np.zeros((1025, 3)), np.ones((1025, 3)), 4)


@pytest.mark.parametrize(("lower", "upper"), [
    (np.zeros((2, 2)), np.zeros((2, 2))), (np.zeros((2, 3)), np.ones((3, 3))), (np.ones((1, 3)), np.zeros((1, 3))),
    (np.full((1, 3), np.nan), np.ones((1, 3))), (np.zeros((1, 3)), np.full((1, 3), np.inf))])
def test_boxes_that_are_none(lower: np.ndarray, upper: np.ndarray) -> None:
    with pytest.raises(ValueError, match="expected"):
        build(lower, upper)


def test_sah_cost_of_two_unit_cubes() -> None:
    """Two unit cubes in the corners of a 1 × 1 × 10 box: a step, then each with the probability of the areas, 6 / 42."""
    lower = np.float32([[0, 0, 0], [0, 0, 9]])
    assert sah_cost(build(lower, lower + 1, 1)) == pytest.approx(1.0 + 2 * 6 / 42)
    assert sah_cost(single_leaf(lower, lower + 1)) == 2.0
    assert sah_cost(build(lower[:0], lower[:0])) == 0.0
    assert sah_cost(build(np.zeros((3, 3)), np.zeros((3, 3)))) == 3.0


def test_leaves_are_split_where_that_is_cheaper() -> None:
    """Of the same two cubes: splitting costs 1 + 12 / 42 intersections, keeping them 2; so a step may cost up to 2 − 12 / 42."""
    lower = np.float32([[0, 0, 0], [0, 0, 9]])
    assert len(build(lower, lower + 1, traversal_cost=1.71).left) == 3
    assert len(build(lower, lower + 1, traversal_cost=1.72).left) == 1


@pytest.mark.parametrize("seed", range(20))
def test_small_nodes_get_the_best_split_of_all(seed: int) -> None:
    """Of four boxes, every way to part them by a plane across an axis is tried here one by one."""
    random = np.random.default_rng(seed)
    lower = random.random((4, 3)).astype(np.float32)
    upper = lower + random.random((4, 3)).astype(np.float32)

    def area(members: list[int]) -> float:
        return float(half_area(lower[members].min(axis=0), upper[members].max(axis=0)))

    best = np.inf
    for axis, left_count in itertools.product(range(3), (1, 2, 3)):
        by_centre = list(np.argsort(lower[:, axis] + upper[:, axis]))
        left, right = by_centre[:left_count], by_centre[left_count:]
        best = min(best, area(left) * len(left) + area(right) * len(right))
    topology = build(lower, upper, 1)
    sides = topology.order[: topology.count[1]].tolist(), topology.order[topology.count[1] :].tolist()
    assert sum(area(side) * len(side) for side in sides) == pytest.approx(best, rel=1e-6)


def test_large_nodes_get_a_split_near_the_best() -> None:
    """Two clusters of different size: the plane lies between them, not at the median."""
    random = np.random.default_rng(3)
    lower = np.concatenate([random.random((900, 3)), random.random((100, 3)) + np.array([0, 20, 0])]).astype(np.float32)
    topology = build(lower, lower + 0.01)
    assert set(topology.count[1:3].tolist()) == {900, 100}
