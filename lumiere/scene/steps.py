"""The steps of a transform."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from lumiere.scene.fields import nested, number, vector
from lumiere.scene.transform import look_at_matrix, rotation_matrix

Vector = tuple[float, float, float]


@dataclass(kw_only=True)
class Rotate:
    """Counter-clockwise as seen with the axis pointing at the viewer, about the origin."""

    axis: Vector = vector(doc="any length but 0")
    angle: float = number(doc="degrees")

    def check(self) -> str | None:
        """What is wrong with the axis, or None."""
        return None if any(self.axis) else "found the axis [0, 0, 0], expected a direction"

    def matrix(self) -> np.ndarray:
        """(4, 4) float64."""
        return rotation_matrix(np.array(self.axis), self.angle)


@dataclass(kw_only=True)
class LookAt:
    """Moves the origin to ``origin`` and turns −Z towards ``target`` and +Y towards ``up``, as a camera stands."""

    origin: Vector = vector(doc="metres")
    target: Vector = vector(doc="metres")
    up: Vector = vector((0.0, 1.0, 0.0), doc="the direction that is up")

    def check(self) -> str | None:
        """What is wrong with the directions, or None."""
        try:
            self.matrix()
        except ValueError:
            return "found equal points, or an up along the line of sight, expected a direction to look in and another that is up"
        return None

    def matrix(self) -> np.ndarray:
        """(4, 4) float64."""
        return look_at_matrix(np.array(self.origin), np.array(self.target), np.array(self.up))


@dataclass(kw_only=True)
class Step:
    """One step of a transform: exactly one of these."""

    translate: Vector | None = vector(None, nullable=True, doc="metres")
    rotate: Rotate | None = nested(Rotate, nullable=True, doc="axis and angle")
    scale: Vector | None = vector(None, nullable=True, broadcast=True, doc="a number, or one an axis; not 0")
    look_at: LookAt | None = nested(LookAt, nullable=True, doc="origin, target, up")
    matrix: tuple[float, ...] | None = vector(None, size=16, nullable=True, doc="row-major, affine: the last row is 0, 0, 0, 1")

    def check(self) -> str | None:
        """What is wrong with the step, or None."""
        names = [f.name for f in fields(self)]
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) != 1:
            return f"found {' and '.join(given) or 'an empty step'}, expected exactly one of: {', '.join(names)}"
        if self.matrix is not None and self.matrix[12:] != (0.0, 0.0, 0.0, 1.0):
            return f"found the last row {list(self.matrix[12:])}, expected [0, 0, 0, 1]: projections are no transforms"
        return None

    def to_matrix(self) -> np.ndarray:
        """(4, 4) float64."""
        if self.rotate is not None:
            return self.rotate.matrix()
        if self.look_at is not None:
            return self.look_at.matrix()
        if self.matrix is not None:
            return np.array(self.matrix).reshape(4, 4)
        matrix = np.eye(4)
        if self.translate is not None:
            matrix[:3, 3] = self.translate
        if self.scale is not None:
            matrix[[0, 1, 2], [0, 1, 2]] = self.scale
        return matrix


def compose(steps: list[Step]) -> np.ndarray:
    """(4, 4) float64 of all steps, the first applied first."""
    matrix = np.eye(4)
    with np.errstate(all="ignore"):  # the caller looks at what is not finite
        for step in steps:
            matrix = step.to_matrix() @ matrix
    return matrix
