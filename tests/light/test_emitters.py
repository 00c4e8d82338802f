"""Shapes that emit and scatter: light sampling, BSDF sampling and both together find the same light."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import lumiere
from tests.render.scenes import index_of

EMITTERS: dict[str, dict[str, Any]] = {
    "sphere": {"type": "sphere"},
    "ellipsoid": {"type": "sphere", "transform": [{"scale": [1.3, 0.5, 1.0]}, {"rotate": {"axis": [0, 0, 1], "angle": 30}}]},
    "disk": {"type": "disk", "normal": [0.2, -1.0, 0.3]},
    "box": {"type": "box", "min": [-0.6, -0.6, -0.6], "max": [0.6, 0.6, 0.6]},
    "rectangle, both sides": {"type": "rectangle", "emission_sides": "both", "transform": [{"rotate": {"axis": [1, 0, 0], "angle": 20}}]},
}


def _scene(shape: dict[str, Any], mode: str) -> dict[str, Any]:
    """An emitter of albedo ½ over a plane: its own surface is lit by the plane, never by itself where it is convex."""
    return {"scene": {
        "camera": {"position": [0, 1, 6]}, "film": {"width": 32, "height": 32},
        "integrator": {"max_depth": 3, "light_sampling": mode, "russian_roulette_depth": None},
        "sampler": {"type": "independent", "spp": 256},
        "materials": {"grey": {"type": "lambert", "albedo": 0.5}},
        "geometry": [shape | {"material": "grey", "emission": 2.0}, {"type": "plane", "position": [0, -1.5, 0], "material": "grey"}]}}


@pytest.mark.parametrize("name", EMITTERS)
def test_light_sampling_strategies_agree(device: Any, name: str) -> None:
    images = {mode: lumiere.render(_scene(EMITTERS[name], mode), device=index_of(device)) for mode in ("mis", "light", "bsdf")}
    means = {mode: image.pixels.mean(dtype=np.float64) for mode, image in images.items()}
    errors = {mode: np.sqrt(image.variance.sum(dtype=np.float64)) / image.pixels.size for mode, image in images.items()}
    for mode in ("mis", "light"):
        # Channels are equal here, so their errors add up rather than average out: √3 more.
        z = (means[mode] - means["bsdf"]) / (np.sqrt(3.0) * np.hypot(errors[mode], errors["bsdf"]))
        assert abs(z) < 4.5, f"{mode} and bsdf differ by {z:.1f} standard errors: {means}"
