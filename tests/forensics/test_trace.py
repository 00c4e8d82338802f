"""A replayed path is the path: its radiance is the sample's, its parts are what is known in closed form."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import numpy as np
import pytest

from lumiere import api
from lumiere.errors import UsageError
from lumiere.scene.model import Scene
from lumiere.trace.report import trace_path
from lumiere.trace.watch import watch


def _scene(**keys: Any) -> Scene:
    return api.load({"scene": {
        "camera": {"position": [0, 1, 4], "look_at": [0, 0.5, 0]}, "film": {"width": 6, "height": 5}, "integrator": {"max_depth": 5},
        "geometry": [{"type": "plane", "name": "floor"},
                     {"type": "sphere", "position": [0, 0.5, 0], "radius": 0.5, "material": {"type": "dielectric"}}],
        "lights": [{"type": "area", "position": [1, 3, 0], "radius": 0.5, "radiance": 12}, {"type": "environment", "radiance": 0.2}], **keys}})


def test_the_radiance_is_that_of_the_sample(device: Any) -> None:
    """One sample a pixel: what trace-path says of sample 0 is the pixel, bit by bit."""
    scene = _scene()
    picture = api.render(scene, spp=1, device=device.name).pixels
    for y, x in ((0, 0), (2, 3), (4, 1), (3, 2)):
        path, _ = watch(scene, (x, y), 0, device.name)
        assert np.array_equal(path.radiance.astype(np.float32), picture[y, x])
        parts = sum(v.emitted + v.connected for v in path.vertices)
        assert np.allclose(parts, path.radiance, rtol=1e-6)


def test_walks_through_bodies_are_followed_to_their_end(device: Any) -> None:
    """Each scattering event is a vertex, and what the path adds behind them is all of the sample."""
    scene = api.load({"scene": {
        "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0], "fov": 20}, "film": {"width": 4, "height": 4}, "integrator": {"max_depth": 30},
        "geometry": [{"type": "sphere", "material": {"type": "subsurface", "albedo": 0.9, "radius": 0.3}}],
        "lights": [{"type": "environment", "radiance": 1}, {"type": "area", "position": [0, 3, 2], "radius": 0.5, "radiance": 9}]}})
    picture = api.render(scene, spp=1, device=device.name).pixels
    events = 0
    for y, x in ((1, 1), (2, 2)):
        path, _ = watch(scene, (x, y), 0, device.name)
        assert np.array_equal(path.radiance.astype(np.float32), picture[y, x])
        assert np.allclose(sum(v.emitted + v.connected for v in path.vertices), path.radiance, rtol=1e-6)
        events += sum(v.program == "scatter" for v in path.vertices)
    assert events > 4
    assert any("scatters in the body" in line for line in trace_path(scene, (1, 1), 0, device.name))


def test_weights_are_those_of_the_densities(device: Any) -> None:
    """The power heuristic of the densities that are told is the weight found by replaying without it; weights are in (0, 1]."""
    scene = dataclasses.replace(_scene(), integrator=dataclasses.replace(_scene().integrator, max_depth=2))
    text = "\n".join(line for x in range(6) for y in (2, 4) for line in trace_path(scene, (x, y), 0, device.name))
    assert "MIS weight" in text and "nan" not in text
    assert "'floor' (plane)" in text and "vertex 1" in text
    weights = [float(part.split()[0].rstrip(",")) for part in text.split("MIS weight ")[1:]]
    assert all(0.0 < weight <= 1.0 + 1e-5 for weight in weights)
    sampled = re.findall(r"shadow ray .* MIS weight (\S+) \(light pdf (\S+), BSDF pdf (\S+)\)", text)
    assert len(sampled) >= 5
    for weight, light, bsdf in np.array(sampled, float):
        assert weight == pytest.approx(light**2 / (light**2 + bsdf**2), rel=1e-3)


def test_a_pixel_outside_is_refused() -> None:
    with pytest.raises(UsageError, match="--pixel: found 6 0, expected x from 0 to 5"):
        watch(_scene(), (6, 0), 0, None)
