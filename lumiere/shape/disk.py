"""The disk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.scene.fields import number, vector
from lumiere.shape import SHAPES, DeviceShape, Primitives, Shape, outwards
from lumiere.shape.plane import orthonormal_basis


class DiskShape(DeviceShape):
    """Centre and two half axes: an ellipse where the transform stretches. The normal is ``axis_u`` × ``axis_v``."""

    name: ClassVar[str] = "disk"
    record: ClassVar[np.dtype] = np.dtype([("center", "<f4", 3), ("axis_u", "<f4", 3), ("axis_v", "<f4", 3)])

    @staticmethod
    def bounds(records: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        center, u, v = (records[name].astype(np.float64) for name in ("center", "axis_u", "axis_v"))
        reach = np.sqrt(u * u + v * v)
        return outwards(center - reach, center + reach)

    @staticmethod
    def areas(records: np.ndarray) -> np.ndarray:
        return np.pi * np.linalg.norm(np.cross(records["axis_u"].astype(np.float64), records["axis_v"].astype(np.float64)), axis=1)


@SHAPES.register
@dataclass(kw_only=True)
class Disk(Shape):
    """A flat disk. uv is the unit square around it."""

    type: ClassVar[str] = "disk"

    position: tuple[float, float, float] = vector((0.0, 0.0, 0.0), doc="the centre, metres")
    normal: tuple[float, float, float] = vector((0.0, 0.0, 1.0), doc="of the front side")
    radius: float = number(1.0, low=0.0, low_open=True, doc="metres")

    def check(self) -> str | None:
        """What is wrong with the normal, or None."""
        return None if any(self.normal) else "found the normal [0, 0, 0], expected a direction"

    def lower(self) -> list[Primitives]:
        matrix = self.matrix()
        u, v, _ = orthonormal_basis(np.array(self.normal))
        axes = [matrix[:3, :3] @ (self.radius * axis) for axis in (u, v)]
        if np.linalg.det(matrix[:3, :3]) < 0.0:
            axes.reverse()  # keeps the front in front under a mirroring transform
        records = np.zeros(1, dtype=DiskShape.record)
        records["center"] = matrix[:3, :3] @ np.array(self.position) + matrix[:3, 3]
        records["axis_u"], records["axis_v"] = axes
        return [Primitives(DiskShape, records)]
