"""Triangles: the device shape of meshes, rectangles and boxes."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from lumiere.shape import DeviceShape, Primitives


class Triangle(DeviceShape):
    """Three vertices in counter-clockwise order seen from the front."""

    name: ClassVar[str] = "triangle"
    record: ClassVar[np.dtype] = np.dtype([("vertices", "<f4", (3, 3))])

    @staticmethod
    def bounds(records: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        vertices = records["vertices"]
        a, b, c = vertices[:, 0], vertices[:, 1], vertices[:, 2]  # in pairs: ten times as fast as along an axis of three
        return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)

    @staticmethod
    def areas(records: np.ndarray) -> np.ndarray:
        vertices = records["vertices"].astype(np.float64)
        return np.linalg.norm(np.cross(vertices[:, 1] - vertices[:, 0], vertices[:, 2] - vertices[:, 0]), axis=1) / 2.0


def triangles(vertices: np.ndarray, faces: np.ndarray, matrix: np.ndarray, *, normals: np.ndarray | None = None,
              uvs: np.ndarray | None = None, colors: np.ndarray | None = None) -> Primitives:
    """Primitives of a mesh: vertices (n, 3), faces (m, 3) and what its vertices carry, put into the world by ``matrix`` (4, 4).

    A mirroring matrix turns the faces over, so that their front stays in front.
    """
    linear = matrix[:3, :3]
    world = (np.asarray(vertices, dtype=np.float64) @ linear.T + matrix[:3, 3]).astype(np.float32)
    faces = np.asarray(faces)
    if np.linalg.det(linear) < 0.0:
        faces = faces[:, ::-1]
    if normals is not None:
        normals = np.asarray(normals, dtype=np.float64) @ np.linalg.inv(linear)  # the inverse transpose, from the right
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = normals / np.where(lengths > 0.0, lengths, 1.0)
    records = np.zeros(len(faces), dtype=Triangle.record)
    records["vertices"] = world[faces]
    carries = normals is not None or uvs is not None or colors is not None
    return Primitives(Triangle, records, indices=faces if carries else None, normals=normals, uvs=uvs, colors=colors)
