"""The spot light."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from lumiere.light import LIGHTS, Light, luminance
from lumiere.scene.fields import Spectrum, number, spectrum, vector


@LIGHTS.register
@dataclass(kw_only=True)
class SpotLight(Light):
    """Light from one point inside a cone; full intensity on the axis, a smooth step to none over the outer ``penumbra`` of the cone."""

    type: ClassVar[str] = "spot"
    record: ClassVar[np.dtype] = np.dtype([
        ("position", "<f4", 3), ("axis", "<f4", 3), ("intensity", "<f4", 3), ("cos_outer", "<f4"), ("cos_inner", "<f4")])

    position: tuple[float, float, float] = vector((0.0, 0.0, 0.0), doc="metres")
    look_at: tuple[float, float, float] = vector((0.0, 0.0, -1.0), doc="a point on the axis")
    intensity: Spectrum = spectrum(1.0, doc="on the axis, W/sr")
    cone: float = number(30.0, low=0.0, high=180.0, low_open=True, doc="half angle, degrees")
    penumbra: float = number(0.1, low=0.0, high=1.0, doc="fraction of the cone's half angle over which the light fades")

    def check(self) -> str | None:
        """What is wrong with the axis, or None."""
        return f"found look_at equal to position {list(self.position)}, expected a point to shine at" if self.position == self.look_at else None

    def device_record(self) -> dict[str, Any]:
        axis = np.subtract(self.look_at, self.position)
        outer = math.radians(self.cone)
        return {"position": self.position, "axis": axis / np.linalg.norm(axis), "intensity": self.intensity,
                "cos_outer": math.cos(outer), "cos_inner": math.cos(outer * (1.0 - self.penumbra))}

    def flux(self, scene_radius: float) -> float:
        outer = math.radians(self.cone)
        middle = (math.cos(outer) + math.cos(outer * (1.0 - self.penumbra))) / 2.0
        return 2.0 * math.pi * (1.0 - middle) * luminance(self.intensity)
