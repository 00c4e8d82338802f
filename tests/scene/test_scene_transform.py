"""Transforms: steps, their order, and the matrices they stand for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lumiere.errors import SceneError
from lumiere.scene.load import load
from lumiere.scene.transform import is_degenerate, look_at_matrix, rotation_matrix


def transform_of(steps: object) -> np.ndarray:
    return load({"scene": {"geometry": [{"type": "box", "transform": steps}]}}).geometry[0].transform


@pytest.mark.parametrize(("steps", "point", "expected"), [
    ([], (1, 2, 3), (1, 2, 3)),
    ([{"translate": [1, 2, 3]}], (1, 1, 1), (2, 3, 4)),
    ([{"scale": 2}], (1, 2, 3), (2, 4, 6)),
    ([{"scale": [1, -1, 3]}], (1, 2, 3), (1, -2, 9)),
    ([{"rotate": {"axis": [0, 0, 9], "angle": 90}}], (1, 0, 5), (0, 1, 5)),
    ([{"rotate": {"axis": [0, 1, 0], "angle": 90}}], (0, 0, 1), (1, 0, 0)),
    ([{"rotate": {"axis": [1, 1, 1], "angle": 120}}], (1, 0, 0), (0, 1, 0)),
    ([{"matrix": [1, 2, 3, 4, 0, 1, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1]}], (1, 1, 1), (10, 6, 7)),
    ([{"translate": [1, 0, 0]}, {"scale": 2}], (0, 0, 0), (2, 0, 0)),
    ([{"scale": 2}, {"translate": [1, 0, 0]}], (0, 0, 0), (1, 0, 0)),
    ([{"translate": [1, 0, 0]}, {"rotate": {"axis": [0, 0, 1], "angle": 90}}, {"scale": [1, 5, 1]}], (0, 0, 0), (0, 5, 0)),
    ([{"look_at": {"origin": [1, 2, 3], "target": [9, 2, 3]}}], (0, 0, 0), (1, 2, 3)),
    ([{"look_at": {"origin": [1, 2, 3], "target": [9, 2, 3]}}], (0, 0, -4), (5, 2, 3)),
    ([{"look_at": {"origin": [1, 2, 3], "target": [9, 2, 3]}}], (0, 1, 0), (1, 3, 3)),
    ([{"look_at": {"origin": [0, 0, 0], "target": [0, -1, 0], "up": [0, 0, -1]}}], (0, 1, 0), (0, 0, -1)),
])
def test_where_a_point_goes(steps: list, point: tuple, expected: tuple) -> None:
    """The first step is applied first; a look_at puts the origin at its origin and −Z towards its target, as a camera stands."""
    matrix = transform_of(steps)
    assert matrix.shape == (4, 4)
    assert matrix.dtype == np.float64
    np.testing.assert_allclose(matrix @ (*point, 1), (*expected, 1), atol=1e-12)


directions = st.tuples(*[st.floats(-10, 10)] * 3).map(np.array).filter(lambda v: np.linalg.norm(v) > 1e-3)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(directions, st.floats(-720, 720))
def test_rotations_keep_lengths_hands_and_the_axis(axis: np.ndarray, angle: float) -> None:
    linear = rotation_matrix(axis, angle)[:3, :3]
    np.testing.assert_allclose(linear @ linear.T, np.eye(3), atol=1e-13)
    assert np.linalg.det(linear) == pytest.approx(1.0)
    np.testing.assert_allclose(linear @ axis, axis, atol=1e-12)
    assert np.trace(linear) == pytest.approx(1.0 + 2.0 * np.cos(np.deg2rad(angle)), abs=1e-12)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(directions, directions, directions)
def test_look_at_is_rigid(origin: np.ndarray, direction: np.ndarray, up: np.ndarray) -> None:
    if np.linalg.norm(np.cross(direction, up)) < 1e-3 * np.linalg.norm(direction) * np.linalg.norm(up):
        return
    matrix = look_at_matrix(origin, origin + direction, up)
    linear = matrix[:3, :3]
    np.testing.assert_allclose(linear @ linear.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(linear) == pytest.approx(1.0)
    np.testing.assert_allclose(-linear[:, 2], direction / np.linalg.norm(direction), atol=1e-9)
    assert linear[:, 1] @ up > 0.0


@pytest.mark.parametrize(("linear", "degenerate"), [
    (np.eye(3), False),
    (np.diag([1e-39, 1e-39, 1e-39]), True),
    (np.diag([1e-30, 1e-30, 1e-30]), False),
    (np.diag([1e30, 1e30, 1e30]), False),
    (np.diag([1e-9, 1.0, 1.0]), False),
    (np.diag([0.0, 1.0, 1.0]), True),
    (np.zeros((3, 3)), True),
    (np.arange(9.0).reshape(3, 3), True),
    (rotation_matrix((1, 2, 3), 40)[:3, :3] @ np.diag([1.0, 0.0, 2.0]) @ rotation_matrix((3, 2, 1), 70)[:3, :3], True),
])
def test_is_degenerate(linear: np.ndarray, degenerate: bool) -> None:
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    assert is_degenerate(matrix) == degenerate


def test_a_numpy_matrix_is_welcome() -> None:
    matrix = np.eye(4)
    matrix[:3, 3] = (1.0, 2.0, 3.0)
    np.testing.assert_array_equal(transform_of([{"matrix": matrix.ravel()}]), matrix)
    with pytest.raises(SceneError, match="expected a list of 16 numbers"):
        transform_of([{"matrix": matrix}])
