"""The thin lens: depth of field."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.camera import CAMERAS
from lumiere.camera.perspective import Perspective
from lumiere.scene.fields import integer, number


@CAMERAS.register
@dataclass(kw_only=True)
class ThinLens(Perspective):
    """A pinhole widened to a lens: what lies in the plane at ``focus_distance`` is sharp (Cook, Porter & Carpenter 1984)."""

    type: ClassVar[str] = "thin_lens"
    device_fields: ClassVar[dict[str, int]] = {"half_extent": 2, "aperture_radius": 1, "focus_distance": 1, "blades": 1}
    uses_lens: ClassVar[bool] = True

    aperture_radius: float = number(0.0, low=0.0, doc="radius of the lens, metres")
    focus_distance: float = number(1.0, low=0.0, low_open=True, doc="from the lens to the plane in focus, along the axis, metres")
    blades: int = integer(0, low=0, high=64, doc="sides of the aperture; 0 = round")

    def check(self) -> str | None:
        if self.blades in (1, 2):
            return f"found {self.blades} blades, expected 0 (round) or at least 3"
        return super().check()

    def device_values(self, width: int, height: int) -> dict[str, Any]:
        lens = {"aperture_radius": self.aperture_radius, "focus_distance": self.focus_distance, "blades": self.blades}
        return super().device_values(width, height) | lens
