"""The fisheye camera."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.camera import CAMERAS, Camera
from lumiere.scene.fields import choice, number


@CAMERAS.register
@dataclass(kw_only=True)
class Fisheye(Camera):
    """Equidistant: the angle to the axis grows with the distance from the picture's centre. Beyond 180° off the axis nothing is seen."""

    type: ClassVar[str] = "fisheye"
    device_fields: ClassVar[dict[str, int]] = {"half_angle": 2}

    fov: float = number(180.0, low=0.0, high=360.0, low_open=True, doc="full angle of view along fov_axis, degrees")
    fov_axis: str = choice("y", ["x", "y", "smaller", "larger"], doc="the side of the picture that fov spans")

    def device_values(self, width: int, height: int) -> dict[str, Any]:
        half = math.radians(self.fov) / 2.0
        along_x = {"x": True, "y": False, "smaller": width < height, "larger": width >= height}[self.fov_axis]
        return {"half_angle": (half, half * height / width) if along_x else (half * width / height, half)}
