"""Scenes far away are moved to the origin, others stay, bit by bit."""

from __future__ import annotations

import numpy as np

from lumiere.compile.recentre import far_center, moved
from lumiere.compile.scene import compile_scene, lower
from lumiere.scene.load import load
from tests.extremes.cases import BASE, placed


def test_what_is_near_stays() -> None:
    assert far_center(lower(load({"scene": BASE}))[0]) is None
    assert not compile_scene(load({"scene": BASE})).origin.any()


def test_what_is_far_is_as_it_was_at_the_origin() -> None:
    """Vertices, spheres, disks, lights and camera of a scene at 10⁷ times its size agree with those at the origin to single precision."""
    offset = np.array([1e7, -3e6, 2e6])
    here, there = load({"scene": BASE}), load({"scene": placed(1.0, tuple(offset))})
    center = far_center(lower(there)[0])
    assert center is not None and np.linalg.norm(center - offset) < 8.0
    back = moved(moved(there, center), offset - center)
    for name, (_, array) in compile_scene(back).arrays.items():
        expected = compile_scene(here).arrays[name][1]
        for field in array.dtype.names or (None,):
            a, b = (array, expected) if field is None else (array[field], expected[field])
            if a.dtype.kind == "f":
                assert np.allclose(a, b, rtol=1e-6, atol=2e-6), (name, field)


def test_the_layer_position_keeps_the_files_coordinates() -> None:
    scene = load({"scene": placed(1.0, (1e5, 0.0, 0.0)) | {"film": {"width": 8, "height": 8, "aovs": ["position"]}}})
    assert not compile_scene(scene).origin.any()
