"""The directional light."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from lumiere.light import LIGHTS, Light, luminance
from lumiere.scene.fields import Spectrum, number, spectrum, vector


@LIGHTS.register
@dataclass(kw_only=True)
class DirectionalLight(Light):
    """Light from very far away: parallel, or, with an ``angle``, from a disk in the sky of that angular diameter that rays can meet."""

    type: ClassVar[str] = "directional"
    record: ClassVar[np.dtype] = np.dtype([("direction", "<f4", 3), ("radiance", "<f4", 3), ("one_minus_cos", "<f4")])

    direction: tuple[float, float, float] = vector((0.0, -1.0, 0.0), doc="of travel")
    irradiance: Spectrum = spectrum(1.0, doc="on a surface that faces the light, W/m²")
    angle: float = number(0.0, low=0.0, high=180.0, high_open=True, doc="angular diameter, degrees")

    def check(self) -> str | None:
        """What is wrong with the direction, or None."""
        return None if any(self.direction) else "found the direction [0, 0, 0], expected another"

    @property
    def device_kind(self) -> str:
        return "sun" if self.angle > 0.0 else "directional"

    @property
    def infinite(self) -> bool:
        return self.angle > 0.0

    def device_record(self) -> dict[str, Any]:
        half = math.radians(self.angle) / 2.0
        # Irradiance of a facing surface under a cone of constant radiance L is π sin²(half) L.
        projected = math.pi * math.sin(half) ** 2 if self.angle > 0.0 else 1.0
        return {"direction": np.divide(self.direction, np.linalg.norm(self.direction)), "radiance": np.divide(self.irradiance, projected),
                "one_minus_cos": 2.0 * math.sin(half / 2.0) ** 2}

    def flux(self, scene_radius: float) -> float:
        return math.pi * scene_radius**2 * luminance(self.irradiance)
