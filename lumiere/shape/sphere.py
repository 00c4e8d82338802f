"""The sphere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.scene.fields import number, vector
from lumiere.shape import SHAPES, DeviceShape, Primitives, Shape, outwards


class SphereShape(DeviceShape):
    """Centre, radius, and the rotation from the world to the sphere's own axes (rows), for uv and tangents."""

    name: ClassVar[str] = "sphere"
    record: ClassVar[np.dtype] = np.dtype([("center", "<f4", 3), ("radius", "<f4"), ("to_local", "<f4", (3, 3))])

    @staticmethod
    def bounds(records: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        center = records["center"].astype(np.float64)
        radius = records["radius"].astype(np.float64)[:, None]
        return outwards(center - radius, center + radius)

    @staticmethod
    def areas(records: np.ndarray) -> np.ndarray:
        return 4.0 * np.pi * records["radius"].astype(np.float64) ** 2


@SHAPES.register
@dataclass(kw_only=True)
class Sphere(Shape):
    """A sphere, normal outwards. uv is lat-long about its own Y: u grows to the right seen from outside with 0.5 at +Z, v from −Y to +Y."""

    type: ClassVar[str] = "sphere"

    position: tuple[float, float, float] = vector((0.0, 0.0, 0.0), doc="the centre, metres")
    radius: float = number(1.0, low=0.0, low_open=True, doc="metres")

    def check(self) -> str | None:
        """What is wrong with the transform, or None."""
        if self.transform is None:
            return None
        linear = self.matrix()[:3, :3]
        gram = linear.T @ linear
        scale = np.trace(gram) / 3.0
        if not np.allclose(gram, scale * np.eye(3), atol=1e-6 * scale):
            return "found a transform that stretches the sphere, expected the same scale on every axis (a stretched sphere is a mesh)"
        return None

    def lower(self) -> list[Primitives]:
        matrix = self.matrix()
        scale = np.cbrt(abs(np.linalg.det(matrix[:3, :3])))
        records = np.zeros(1, dtype=SphereShape.record)
        records["center"] = matrix[:3, :3] @ np.array(self.position) + matrix[:3, 3]
        records["radius"] = self.radius * scale
        records["to_local"] = matrix[:3, :3].T / scale
        return [Primitives(SphereShape, records)]
