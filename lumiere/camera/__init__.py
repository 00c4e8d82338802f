"""Cameras: one file a kind, each mirrored by ``cl/camera/NAME.cl``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from lumiere.registry import Registry
from lumiere.scene.fields import transform, vector
from lumiere.scene.transform import look_at_matrix


@dataclass(kw_only=True)
class Camera:
    """A camera: where it stands, and how a point of the picture becomes a ray.

    ``device_fields`` declares the record that ``cl/camera/TYPE.cl`` reads beyond ``to_world``: names and how many floats each is.
    ``device_values(width, height)`` gives their values. ``uses_lens``: the kind takes two random numbers for a point on the lens.
    """

    type: ClassVar[str]
    device_fields: ClassVar[dict[str, int]] = {}
    uses_lens: ClassVar[bool] = False

    position: tuple[float, float, float] | None = vector(None, nullable=True, doc="where the camera stands, metres")
    look_at: tuple[float, float, float] | None = vector(None, nullable=True, doc="the point that it looks at")
    up: tuple[float, float, float] = vector((0.0, 1.0, 0.0), doc="the direction that is up in the picture")
    transform: Any = transform(doc="instead of position and look_at: camera to world; the camera looks down −Z, +Y up")

    def check(self) -> str | None:
        """What is wrong with the camera's placement, or None."""
        if self.transform is not None:
            if self.position is not None or self.look_at is not None:
                return "found both transform and position or look_at, expected one of the two"
            return None
        position = np.array(self.position or (0.0, 0.0, 0.0))
        target = np.array(self.look_at) if self.look_at is not None else position + np.array((0.0, 0.0, -1.0))
        forward = target - position
        length, up_length = np.linalg.norm(forward), np.linalg.norm(self.up)
        if length == 0.0:
            return f"found look_at equal to position {list(position)}, expected a point to look at"
        if up_length == 0.0 or np.linalg.norm(np.cross(forward / length, np.array(self.up) / up_length)) < 1e-6:
            return f"found up {list(self.up)} along the view direction, expected another direction"
        return None

    def to_world(self) -> np.ndarray:
        """Camera to world, (4, 4) float64; the camera looks down −Z with +Y up."""
        if self.transform is not None:
            return np.asarray(self.transform, dtype=np.float64)
        position = np.array(self.position or (0.0, 0.0, 0.0))
        target = np.array(self.look_at) if self.look_at is not None else position + np.array((0.0, 0.0, -1.0))
        return look_at_matrix(position, target, np.array(self.up))

    def device_values(self, width: int, height: int) -> dict[str, Any]:
        """Values of ``device_fields`` for a film of ``width`` × ``height`` pixels."""
        return {}


CAMERAS: Registry[Camera] = Registry("lumiere.camera", "camera")
