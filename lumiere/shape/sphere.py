"""The sphere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.scene.fields import number, vector
from lumiere.shape import SHAPES, DeviceShape, Primitives, Shape, outwards
from lumiere.shape.ellipsoid import ellipsoid


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
    """A sphere, normal outwards; an ellipsoid where its transform stretches it. uv is lat-long about its own Y: u grows to the right seen from
    outside with 0.5 at +Z, v from −Y to +Y.
    """

    type: ClassVar[str] = "sphere"

    position: tuple[float, float, float] = vector((0.0, 0.0, 0.0), doc="the centre, metres")
    radius: float = number(1.0, low=0.0, low_open=True, doc="metres")

    def lower(self) -> list[Primitives]:
        matrix = self.matrix()
        linear = matrix[:3, :3]
        center = linear @ np.array(self.position) + matrix[:3, 3]
        gram = linear.T @ linear
        scale2 = np.trace(gram) / 3.0
        if self.transform is not None and not np.allclose(gram, scale2 * np.eye(3), atol=1e-6 * scale2):
            return [ellipsoid(center, self.radius * linear)]
        scale = np.sqrt(scale2)
        records = np.zeros(1, dtype=SphereShape.record)
        records["center"] = center
        records["radius"] = self.radius * scale
        records["to_local"] = linear.T / scale
        return [Primitives(SphereShape, records)]
