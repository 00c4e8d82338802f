"""Triangles that cannot be rendered, and normals made from faces."""

from __future__ import annotations

import numpy as np
import pytest

from lumiere.meshfile import clean, vertex_normals

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [np.nan, 0, 0], [0, np.inf, 0], [0, 0, 1e39]], np.float64)


def test_each_sort_is_counted_once() -> None:
    faces = np.array([[0, 1, 2], [0, 1, 3], [0, 1, 1], [2, 2, 2], [0, 1, 4], [5, 5, 5], [0, 1, 6], [2, 1, 0]])
    kept, dropped = clean(VERTICES, faces)
    assert kept.tolist() == [[0, 1, 2], [2, 1, 0]]
    assert dropped == {"not finite": 3, "repeated index": 2, "zero area": 1}


def test_good_faces_are_left_alone() -> None:
    faces = np.array([[0, 1, 2]])
    assert clean(VERTICES, faces)[1] == {}
    kept, dropped = clean(np.zeros((0, 3)), np.zeros((0, 3), int))
    assert kept.shape == (0, 3) and dropped == {}


@pytest.mark.parametrize("scale", [1e-37, 1.0, 1e37])
def test_area_is_judged_at_any_scale(scale: float) -> None:
    """Points on a line through the integers, and the same with one of them off it by the least there is."""
    random = np.random.default_rng(1)
    start, step = random.integers(8, 20, (500, 1, 3)), random.integers(1, 5, (500, 1, 3))
    line = (start + step * np.array([[0], [1], [3]])).astype(np.float64)
    off_line = line.copy()
    off_line[:, 1, 0] = np.nextafter(np.float32(line[:, 1, 0]), np.float32(np.inf))
    faces = np.arange(1500).reshape(-1, 3)
    power = 2.0 ** np.round(np.log2(scale))
    assert clean(line.reshape(-1, 3) * power, faces)[1] == {"zero area": 500}
    assert clean(off_line.reshape(-1, 3) * power, faces)[1] == {}


def test_normals_of_an_octahedron_point_outwards() -> None:
    vertices = np.concatenate([np.eye(3), -np.eye(3)])
    faces = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])
    assert vertex_normals(vertices, faces) == pytest.approx(vertices)
    assert vertex_normals(vertices * 1e-30, faces) == pytest.approx(vertices)
    unused = np.concatenate([vertices, np.ones((1, 3))])
    assert vertex_normals(unused, faces)[-1].tolist() == [0, 0, 0]
    assert vertex_normals(vertices, np.zeros((0, 3), int)).tolist() == np.zeros((6, 3)).tolist()


def test_normals_do_not_depend_on_how_a_corner_is_cut() -> None:
    """At the corner of a cube: one side as a square corner, or cut into two triangles of unequal angles."""
    tip = [0, 0, 0]
    plain = vertex_normals(np.array([tip, [1, 0, 0], [0, 1, 0], [0, 0, 1]]), np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]]))[0]
    cut = vertex_normals(np.array([tip, [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0.2, 0]]), np.array([[0, 1, 4], [0, 4, 2], [0, 2, 3], [0, 3, 1]]))[0]
    assert plain == pytest.approx(np.full(3, 3**-0.5))
    assert cut == pytest.approx(plain)
