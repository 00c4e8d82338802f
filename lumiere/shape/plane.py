"""The infinite plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.scene.fields import vector
from lumiere.shape import SHAPES, DeviceShape, Primitives, Shape


def orthonormal_basis(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit u, v, n, right-handed, with n along ``normal`` (non-zero)."""
    n = np.asarray(normal, dtype=np.float64) / np.linalg.norm(normal)
    helper = np.array([1.0, 0.0, 0.0]) if abs(n[0]) < 0.7 else np.array([0.0, 1.0, 0.0])
    u = np.cross(helper, n)
    u /= np.linalg.norm(u)
    return u, np.cross(n, u), n


class PlaneShape(DeviceShape):
    """A point, the unit normal and a unit tangent. Without bounds and without area: a light only to the rays that happen to meet it."""

    name: ClassVar[str] = "plane"
    record: ClassVar[np.dtype] = np.dtype([("point", "<f4", 3), ("normal", "<f4", 3), ("tangent", "<f4", 3)])
    bounded: ClassVar[bool] = False

    @staticmethod
    def areas(records: np.ndarray) -> np.ndarray:
        return np.zeros(len(records))


@SHAPES.register
@dataclass(kw_only=True)
class Plane(Shape):
    """An infinite plane. uv is in metres along two axes of the plane, from ``position``."""

    type: ClassVar[str] = "plane"

    position: tuple[float, float, float] = vector((0.0, 0.0, 0.0), doc="a point of the plane, metres")
    normal: tuple[float, float, float] = vector((0.0, 1.0, 0.0), doc="of the front side")

    def check(self) -> str | None:
        """What is wrong with the normal, or None."""
        return None if any(self.normal) else "found the normal [0, 0, 0], expected a direction"

    def lower(self) -> list[Primitives]:
        matrix = self.matrix()
        u, _, n = orthonormal_basis(np.array(self.normal))
        normal = np.linalg.inv(matrix[:3, :3]).T @ n
        normal /= np.linalg.norm(normal)
        tangent = matrix[:3, :3] @ u
        tangent -= normal * (normal @ tangent)
        records = np.zeros(1, dtype=PlaneShape.record)
        records["point"] = matrix[:3, :3] @ np.array(self.position) + matrix[:3, 3]
        records["normal"] = normal
        records["tangent"] = tangent / np.linalg.norm(tangent)
        return [Primitives(PlaneShape, records)]
