"""The orthographic camera."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.camera import CAMERAS, Camera
from lumiere.scene.fields import number


@CAMERAS.register
@dataclass(kw_only=True)
class Orthographic(Camera):
    """Parallel rays: nothing shrinks with distance."""

    type: ClassVar[str] = "orthographic"
    device_fields: ClassVar[dict[str, int]] = {"half_extent": 2}

    height: float = number(2.0, low=0.0, low_open=True, doc="height of the whole picture, metres")

    def device_values(self, width: int, height: int) -> dict[str, Any]:
        return {"half_extent": (self.height * width / height / 2.0, self.height / 2.0)}
