"""Coloured glass: Beer's law over the way inside."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

import lumiere
from lumiere.compile.scene import compile_scene


def pane(thickness: float, **glass: object) -> dict[str, object]:
    """A slab of index 1, through which a white sky is seen head on."""
    return {"scene": {
        "film": {"width": 4, "height": 4}, "camera": {"type": "orthographic", "position": [0, 0, 9], "look_at": [0, 0, 0], "height": 1},
        "geometry": [{"type": "box", "min": [-5, -5, 0], "max": [5, 5, thickness], "material": {"type": "dielectric", "ior": 1, **glass}}],
        "lights": [{"type": "environment", "radiance": 1}]}}


@pytest.mark.parametrize("roughness", [0.0, 0.5])
@pytest.mark.parametrize("thickness", [0.5, 2.0])
def test_beers_law(device: cl.Device, thickness: float, roughness: float) -> None:
    color = np.array([0.25, 0.5, 1.0])
    image = lumiere.render(pane(thickness, roughness=roughness, transmittance=list(color), transmittance_distance=1.0), spp=2, device=device.name)
    np.testing.assert_allclose(image.pixels, np.broadcast_to(color**thickness, (4, 4, 3)), rtol=1e-4)


def test_without_a_distance_each_crossing_tints(device: cl.Device) -> None:
    image = lumiere.render(pane(2.0, transmittance=0.5), spp=2, device=device.name)
    np.testing.assert_allclose(image.pixels, 0.25, rtol=1e-4)


def test_only_absorbing_glass_computes_it() -> None:
    assert compile_scene(lumiere.load(pane(1.0))).features.bsdf_features["dielectric"] == ()
    assert compile_scene(lumiere.load(pane(1.0, transmittance_distance=1.0))).features.bsdf_features["dielectric"] == ("ABSORPTION",)
