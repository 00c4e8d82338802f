"""Affine transforms as (4, 4) float64 matrices acting on column vectors."""

from __future__ import annotations

import numpy as np


def look_at_matrix(origin: np.ndarray, target: np.ndarray, up: np.ndarray) -> np.ndarray:
    """The rigid transform that puts an object that looks down −Z, +Y up, at ``origin`` with its −Z towards ``target``.

    Raises ValueError where the direction or ``up`` is zero or the two are parallel.
    """
    back = np.asarray(origin, dtype=np.float64) - np.asarray(target, dtype=np.float64)
    length = np.linalg.norm(back)
    up = np.asarray(up, dtype=np.float64)
    if length == 0.0 or not np.any(up):
        raise ValueError("look_at needs two different points and a non-zero up")
    back /= length
    right = np.cross(up / np.linalg.norm(up), back)
    width = np.linalg.norm(right)
    if width < 1e-9:
        raise ValueError("look_at needs an up that is not along the view direction")
    right /= width
    matrix = np.eye(4)
    matrix[:3, 0] = right
    matrix[:3, 1] = np.cross(back, right)
    matrix[:3, 2] = back
    matrix[:3, 3] = origin
    return matrix


def rotation_matrix(axis: np.ndarray, angle: float) -> np.ndarray:
    """The rotation by ``angle`` degrees, counter-clockwise as seen with the non-zero ``axis`` pointing at the viewer (Rodrigues' formula)."""
    x, y, z = np.asarray(axis, dtype=np.float64) / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.deg2rad(angle)
    matrix = np.eye(4)
    matrix[:3, :3] += np.sin(turn) * cross + (1.0 - np.cos(turn)) * (cross @ cross)
    return matrix


def is_degenerate(matrix: np.ndarray) -> bool:
    """Whether the linear part of the finite ``matrix`` flattens space: its smallest singular value is nothing beside its largest, or to a float32."""
    values = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return bool(values[-1] <= max(1e-12 * values[0], np.finfo(np.float32).tiny))
