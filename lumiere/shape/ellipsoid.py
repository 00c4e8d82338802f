"""The ellipsoid: the device shape of a sphere that its transform stretches."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from lumiere.shape import DeviceShape, Primitives, outwards


class EllipsoidShape(DeviceShape):
    """Centre, and the linear maps from the unit sphere to the world and back (rows); ``volume`` is the first one's |determinant|."""

    name: ClassVar[str] = "ellipsoid"
    record: ClassVar[np.dtype] = np.dtype([("center", "<f4", 3), ("volume", "<f4"), ("to_world", "<f4", (3, 3)), ("to_local", "<f4", (3, 3))])

    @staticmethod
    def bounds(records: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        center = records["center"].astype(np.float64)
        # A row's length is how far the unit sphere reaches along that axis; a little more, for the rounding of the device's maps.
        reach = np.linalg.norm(records["to_world"].astype(np.float64), axis=2) * (1.0 + 1e-6)
        return outwards(center - reach, center + reach)

    @staticmethod
    def areas(records: np.ndarray) -> np.ndarray:
        # Thomsen's formula (2004) with p = 1.6075, good to 1.1 %: it only weighs lights against each other.
        axes = np.linalg.svd(records["to_world"].astype(np.float64), compute_uv=False) ** 1.6075
        a, b, c = axes.T
        return 4.0 * np.pi * ((a * b + a * c + b * c) / 3.0) ** (1.0 / 1.6075)


def ellipsoid(center: np.ndarray, to_world: np.ndarray) -> Primitives:
    """The image of the unit sphere under ``to_world`` (3, 3), moved to ``center``."""
    records = np.zeros(1, dtype=EllipsoidShape.record)
    records["center"] = center
    records["volume"] = abs(np.linalg.det(to_world))
    records["to_world"] = to_world
    records["to_local"] = np.linalg.inv(to_world)
    return Primitives(EllipsoidShape, records)
