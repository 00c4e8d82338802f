"""The box."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.scene.fields import vector
from lumiere.shape import SHAPES, Primitives, Shape
from lumiere.shape.triangle import triangles


@SHAPES.register
@dataclass(kw_only=True)
class Box(Shape):
    """An axis-aligned box in its own space, normals outwards, each face with uv from (0, 0) to (1, 1): twelve triangles."""

    type: ClassVar[str] = "box"

    min: tuple[float, float, float] = vector((-1.0, -1.0, -1.0), doc="the corner with the smallest coordinates")
    max: tuple[float, float, float] = vector((1.0, 1.0, 1.0), doc="the corner with the largest coordinates")

    def check(self) -> str | None:
        """What is wrong with the corners, or None."""
        if any(low >= high for low, high in zip(self.min, self.max, strict=True)):
            return f"found min {list(self.min)} and max {list(self.max)}, expected min below max on every axis"
        return None

    def lower(self) -> list[Primitives]:
        corners = np.array([self.min, self.max])
        vertices, faces, uvs = [], [], []
        for axis in range(3):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            for side in (0, 1):
                # Counter-clockwise seen from outside: along u then v on the far side, the reverse on the near one.
                square = [(0, 0), (1, 0), (1, 1), (0, 1)] if side else [(1, 0), (0, 0), (0, 1), (1, 1)]
                first = len(vertices)
                for i, j in square:
                    vertex = np.zeros(3)
                    vertex[axis], vertex[u], vertex[v] = corners[side, axis], corners[i, u], corners[j, v]
                    vertices.append(vertex)
                uvs += [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
                faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
        return [triangles(np.array(vertices), np.array(faces), self.matrix(), uvs=np.array(uvs))]
