"""The rectangle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumiere.shape import SHAPES, Primitives, Shape
from lumiere.shape.triangle import triangles


@SHAPES.register
@dataclass(kw_only=True)
class Rectangle(Shape):
    """The square [−1, 1]² in XY, normal +Z, uv from (0, 0) at (−1, −1) to (1, 1), placed by its transform: two triangles."""

    type: ClassVar[str] = "rectangle"

    def lower(self) -> list[Primitives]:
        corners = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
        return [triangles(corners, np.array([[0, 1, 2], [0, 2, 3]]), self.matrix(), uvs=(corners[:, :2] + 1.0) / 2.0)]
