"""The point light."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from lumiere.light import LIGHTS, Light, luminance
from lumiere.scene.fields import Spectrum, spectrum, vector


@LIGHTS.register
@dataclass(kw_only=True)
class PointLight(Light):
    """Light from one point, the same in all directions."""

    type: ClassVar[str] = "point"
    record: ClassVar[np.dtype] = np.dtype([("position", "<f4", 3), ("intensity", "<f4", 3)])

    position: tuple[float, float, float] = vector((0.0, 0.0, 0.0), doc="metres")
    intensity: Spectrum = spectrum(1.0, doc="W/sr")

    def device_record(self) -> dict[str, Any]:
        return {"position": self.position, "intensity": self.intensity}

    def flux(self, scene_radius: float) -> float:
        return 4.0 * math.pi * luminance(self.intensity)
