"""A plain list of triangles that sixteen rays meet at once, for a handful of triangles on devices with wide vectors."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from lumiere.accel import Accelerator
from lumiere.accel.build import Topology, single_leaf

ROUNDING = 2.0**-24
"""Half the distance from 1 to the next float32."""


class Flat16(Accelerator):
    """80 bytes a triangle. Two in a row that are a parallelogram but for roundings, as those of rectangles and boxes, are met as one.

    ``planes``: (n, 20) float32: vertex 0; the edges e1 and e2 from it to vertices 1 and 2, and their cross product n, all times a power of two that
    brings n to the order of 1; the bound of the rounding of a height over the plane, relative to |v0 − o| (x, y, z) for the origin o; that of the ray's
    edge functions, E relative to |v0 − o|₁ and T, where the direction's coordinates are at most 1; 1 where the triangle and the next are one parallelogram,
    of which e1 and e2 then are the edges, or 0. Then nothing.
    """

    name: ClassVar[str] = "flat16"

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology:
        """One leaf, the triangles in their own order."""
        return single_leaf(lower, upper)

    def encode(self, topology: Topology, records: np.ndarray) -> dict[str, np.ndarray]:
        """The array above, for triangle ``records``."""
        v0, v1, v2 = np.moveaxis(records["vertices"].astype(np.float32), 1, 0)
        paired, gap = _parallelograms(v0, v1, v2)
        v2 = np.where(paired[:, None], np.roll(v2, -1, axis=0), v2)
        planes = np.zeros((len(records), 20), np.float32)
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows is left to the test of single rays
            e1, e2 = v1 - v0, v2 - v0
            (x1, y1, z1), (x2, y2, z2) = e1.T, e2.T
            normal = np.stack([y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2], axis=1)
            products = np.abs([y1 * z2, z1 * y2, z1 * x2, x1 * z2, x1 * y2, y1 * x2])
            terms = (products[0::2] + products[1::2]).T
            edge = np.maximum(np.abs(e1).sum(axis=1), np.abs(e2).sum(axis=1))[:, None]
            _, exponent = np.frexp(np.abs(normal).max(axis=1, keepdims=True))
            # Some twenty roundings of u, of v and of what they leave of the determinant; and as many of the test of single rays.
            # Where a parallelogram's corner is not that of its triangles, edge functions are off by as much times an edge and a direction, at most √3 long.
            scaled = np.ldexp(np.concatenate([e1, e2, normal, 8.0 * ROUNDING * terms, 64.0 * ROUNDING * edge,
                                              64.0 * ROUNDING * terms.sum(axis=1, keepdims=True) + 4.0 * gap[:, None] * edge], axis=1), -exponent)
            planes[:, :3], planes[:, 3:17] = v0, scaled
            planes[:, 16] += 1e-36  # products may underflow, too
            planes[:, 17] = paired
        return {"planes": planes}


def _parallelograms(v0: np.ndarray, v1: np.ndarray, v2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,) bool: whether triangle i, of vertices a, b, c, and the next, of a, c, d, are the parallelogram a, b, c, d up to the roundings of its corners;
    no triangle is of two. (n,) float64: how far c is from b + d − a there, |·|₁, else 0.
    """
    a, b, c, d = (v.astype(np.float64) for v in (v0[:-1], v1[:-1], v2[:-1], v2[1:]))
    paired, gap = np.zeros(len(v0), bool), np.zeros(len(v0))
    with np.errstate(over="ignore", invalid="ignore"):
        off, corners = np.abs(a + c - b - d), np.abs([a, b, c, d]).sum(axis=0)
        whole = np.all((a == v0[1:]) & (c == v1[1:]) & (off <= ROUNDING * corners), axis=1)
    for i in np.flatnonzero(whole):
        paired[i] = i == 0 or not paired[i - 1]
        gap[i] = off[i].sum() if paired[i] else 0.0
    return paired, gap
