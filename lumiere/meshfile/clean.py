"""Triangles that cannot be rendered, found and counted; vertex normals from faces."""

from __future__ import annotations

import numpy as np


def wrong_index(faces: np.ndarray, count: int) -> str | None:
    """What is wrong with the indices of ``faces``, (m, 3) int, into ``count`` vertices, or None."""
    if not len(faces) or (faces.min() >= 0 and faces.max() < count):
        return None
    worst = faces.max() if faces.max() >= count else faces.min()
    return f"found a face with vertex {worst}, expected one of the {count} vertices{f', 0 to {count - 1}' if count else ''}"


def clean(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, dict[str, int]]:
    """``faces`` without those that cannot be rendered, and how many of each sort those were (only sorts that occur).

    ``vertices``: (n, 3) float; ``faces``: (m, 3) int, indices of vertices. The sorts, a face counting for the first: ``not finite`` (a
    coordinate that is NaN, or infinite as a float32), ``repeated index``, ``zero area`` (three vertices on a line).
    """
    vertices, faces = np.asarray(vertices, np.float64), np.asarray(faces, np.int64).reshape(-1, 3)
    dropped = {}

    def drop(sort: str, bad: np.ndarray) -> None:
        nonlocal faces
        if bad.any():
            dropped[sort] = int(np.count_nonzero(bad))
            faces = faces[~bad]

    with np.errstate(over="ignore"):
        finite = np.isfinite(vertices.astype(np.float32)).all(axis=1)
    if not finite.all():
        drop("not finite", ~finite[faces].all(axis=1))
    a, b, c = faces.T
    drop("repeated index", (a == b) | (b == c) | (c == a))
    if len(faces):
        drop("zero area", ~_crosses(vertices, faces).any(axis=1))
    return faces, dropped


def _crosses(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(m, 3) cross products of two edges of each face, the edges scaled by powers of two so that nothing under- or overflows."""
    v0 = vertices[faces[:, 0]]
    edges = [vertices[faces[:, i]] - v0 for i in (1, 2)]
    (x1, y1, z1), (x2, y2, z2) = (np.ldexp(e, -np.frexp(np.abs(e).max(axis=1, keepdims=True))[1]).T for e in edges)
    return np.stack([y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2], axis=1)


def vertex_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(n, 3) float64 unit normals, the mean of the faces' around each vertex weighted by the angle there (Thürmer & Wüthrich 1998); 0 where
    there is no face. ``vertices``: (n, 3) float; ``faces``: (m, 3) int as ``clean`` leaves them.
    """
    vertices = np.asarray(vertices, np.float64)
    normals = np.zeros((len(vertices), 3))
    if not len(faces):
        return normals
    face_normals = _unit(_crosses(vertices, faces))
    for corner in range(3):
        here, following, preceding = (vertices[faces[:, (corner + i) % 3]] for i in range(3))
        angle = np.arccos(np.clip((_unit(following - here) * _unit(preceding - here)).sum(axis=1), -1.0, 1.0))
        for axis in range(3):
            normals[:, axis] += np.bincount(faces[:, corner], angle * face_normals[:, axis], len(vertices))
    return _unit(normals)


def _unit(vectors: np.ndarray) -> np.ndarray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(lengths > 0.0, lengths, 1.0)
