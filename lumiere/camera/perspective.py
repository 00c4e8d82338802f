"""The pinhole camera."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.camera import CAMERAS, Camera
from lumiere.scene.fields import choice, number


def half_extent(fov: float, fov_axis: str, width: int, height: int) -> tuple[float, float]:
    """Half width and height of the picture on the plane at distance 1, for a full angle ``fov`` in degrees along ``fov_axis``."""
    half = math.tan(math.radians(fov) / 2.0)
    along_x = {"x": True, "y": False, "smaller": width < height, "larger": width >= height}[fov_axis]
    return (half, half * height / width) if along_x else (half * width / height, half)


@CAMERAS.register
@dataclass(kw_only=True)
class Perspective(Camera):
    """A pinhole: every ray passes through ``position``; straight lines stay straight."""

    type: ClassVar[str] = "perspective"
    device_fields: ClassVar[dict[str, int]] = {"half_extent": 2}

    fov: float = number(40.0, low=0.0, high=180.0, low_open=True, high_open=True, doc="full angle of view along fov_axis, degrees")
    fov_axis: str = choice("y", ["x", "y", "smaller", "larger"], doc="the side of the picture that fov spans")

    def device_values(self, width: int, height: int) -> dict[str, Any]:
        return {"half_extent": half_extent(self.fov, self.fov_axis, width, height)}
