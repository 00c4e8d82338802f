"""One small profile for all tests of a device."""

from __future__ import annotations

from typing import Any

import pytest

from lumiere.profile.measure import Profile, measure
from lumiere.scene.load import load

SCENE: dict[str, Any] = {"scene": {
    "camera": {"position": [0, 1, 4], "look_at": [0, 0.5, 0]}, "film": {"width": 16, "height": 12}, "integrator": {"max_depth": 4},
    "sampler": {"spp": 8},
    "geometry": [{"type": "plane", "material": {"type": "lambert", "albedo": 0.8}}, {"type": "sphere", "position": [0, 0.5, 0], "radius": 0.5}],
    "lights": [{"type": "environment", "radiance": 1.0}]}}


@pytest.fixture(scope="module")
def profile(device: Any) -> Profile:
    """Of SCENE: a plane and a sphere under a sky."""
    return measure(load(SCENE), device.name)
