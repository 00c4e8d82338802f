"""Statistical tests, for whatever draws samples: BSDFs, lights, cameras, filters.

A routine that samples a density is tested by counting its samples in cells and integrating the density over the same cells::

    cells = Cells.around(pilot_samples, low, high)         # small where the density is high
    integral, error = cells.integrate(density)
    p = chi_square(cells.count(samples), n * integral)
    assert p > sidak(1e-3, number_of_such_tests)

Nothing here has a tolerance of its own: significance levels and quadrature errors are the caller's, and are seen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy import stats

Array = np.ndarray


def sidak(significance: float, tests: int) -> float:
    """The significance level of each of ``tests`` independent tests so that all of them together have ``significance`` (Šidák 1967)."""
    return -np.expm1(np.log1p(-significance) / tests)


def chi_square(observed: Array, expected: Array, smallest: float = 10.0) -> float:
    """p-value of Pearson's χ² test of counts against their expectations, both of shape (n,).

    Cells are pooled, in ascending order of expectation, until each pool expects ``smallest`` samples; what remains joins the last.
    """
    order = np.argsort(expected, kind="stable")
    pools_observed, pools_expected = [0.0], [0.0]
    for o, e in zip(observed[order], expected[order], strict=True):
        if pools_expected[-1] >= smallest:
            pools_observed.append(0.0)
            pools_expected.append(0.0)
        pools_observed[-1] += o
        pools_expected[-1] += e
    if len(pools_expected) > 1 and pools_expected[-1] < smallest:
        o, e = pools_observed.pop(), pools_expected.pop()
        pools_observed[-1] += o
        pools_expected[-1] += e
    o, e = np.array(pools_observed), np.array(pools_expected)
    if len(o) == 1:
        return 1.0 if np.isclose(o[0], e[0]) else 0.0
    return float(stats.chi2.sf(np.sum(np.square(o - e) / e), len(o) - 1))


def z_test(difference: Array, variance: Array) -> Array:
    """p-values, two-sided, of differences that should be 0 in the mean and have this variance. Where it is 0: 1 if equal, else 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.abs(difference) / np.sqrt(variance)
    return np.where(np.isnan(z), 1.0, 2.0 * stats.norm.sf(z))


def mean_and_variance(samples: Array) -> tuple[Array, Array]:
    """Mean over the first axis, and the variance of that mean."""
    return samples.mean(axis=0), samples.var(axis=0, ddof=1) / len(samples)


@cache
def _gauss_legendre(order: int, dimensions: int) -> tuple[Array, Array]:
    """Nodes (order^d, d) and weights (order^d,) on the unit cube."""
    x, w = np.polynomial.legendre.leggauss(order)
    nodes = np.stack(np.meshgrid(*[0.5 * (x + 1.0)] * dimensions, indexing="ij"), -1).reshape(-1, dimensions)
    weights = np.prod(np.stack(np.meshgrid(*[0.5 * w] * dimensions, indexing="ij"), -1), -1).ravel()
    return nodes, weights


def integrate(function: Callable[[Array], Array], low: Array, high: Array, tolerance: float = 1e-3, levels: int = 10,
              order: int = 4) -> tuple[Array, Array]:
    """Integrals of ``function`` over boxes, by Gauss–Legendre cubature that bisects each box until its halves agree with it.

    ``function`` maps points (n, d) to values (n, k); ``low`` and ``high`` are the boxes' corners, (m, d). Returns the integrals (m, k) and
    estimates of their errors (m, k). ``tolerance`` is absolute and shared by all boxes; a box is bisected at most ``levels`` times along each
    axis, so that a discontinuity leaves an error, which is reported. Boxes should be small where the function is sharp: a peak that all nodes
    of a box miss is missed.
    """
    count, dimensions = low.shape
    nodes, weights = _gauss_legendre(order, dimensions)
    halves = np.stack(np.meshgrid(*[[False, True]] * dimensions, indexing="ij"), -1).reshape(-1, dimensions)
    children = len(halves)

    def cubature(a: Array, b: Array) -> Array:
        points = a[:, None] + (b - a)[:, None] * nodes
        values = np.asarray(function(points.reshape(-1, dimensions)), np.float64).reshape(len(a), len(nodes), -1)
        return np.prod(b - a, axis=1)[:, None] * np.einsum("j,ijk->ik", weights, values)

    owner, share = np.arange(count), np.full(count, tolerance / count)
    coarse = cubature(low, high)
    total, error = np.zeros_like(coarse), np.zeros_like(coarse)
    for level in range(levels):
        middle = 0.5 * (low + high)[:, None]
        fine_low = np.where(halves, middle, low[:, None]).reshape(-1, dimensions)
        fine_high = np.where(halves, high[:, None], middle).reshape(-1, dimensions)
        fine = cubature(fine_low, fine_high).reshape(len(low), children, -1)
        difference = np.abs(fine.sum(axis=1) - coarse)
        done = (difference.max(axis=1) <= share) | (level == levels - 1)
        np.add.at(total, owner[done], fine[done].sum(axis=1))
        np.add.at(error, owner[done], difference[done])
        if done.all():
            break
        again = np.repeat(~done, children)
        low, high, coarse = fine_low[again], fine_high[again], fine[~done].reshape(-1, fine.shape[2])
        owner, share = np.repeat(owner[~done], children), np.repeat(0.5 * share[~done], children)
    return total, error


def _crowding(points: Array, a: Array, b: Array) -> Array:
    """(d,) Kolmogorov–Smirnov statistics, times √n, of the points' coordinates against uniform ones in the box from ``a`` to ``b``."""
    n = len(points)
    sorted_points = (np.sort(points, axis=0) - a) / (b - a)
    rank = np.arange(n)[:, None]
    return np.sqrt(n) * np.maximum((rank + 1) / n - sorted_points, sorted_points - rank / n).max(axis=0)


@dataclass
class Cells:
    """A partition of a box in ``size`` cells, the leaves of a k-d tree. For cubature, cells are cut in boxes (n, d); ``owner`` is a box's cell."""

    size: int
    low: Array
    high: Array
    owner: Array
    _axis: Array
    _split: Array
    _children: Array

    @classmethod
    def around(cls, pilot: Array, low: Array, high: Array, depth: int = 8, cuts: dict[int, float] | None = None) -> Cells:
        """2^depth cells with about equally many of the ``pilot`` points (n, d) each, in the box from ``low`` to ``high``.

        ``cuts`` (axis → value) are made first: planes that no cell shall straddle. Test with other samples than the pilot's.
        """
        boxes: list[tuple[Array, Array, int]] = []
        tree: list[tuple[int, float, int, int]] = []
        size = 0

        def halves(points: Array, a: Array, b: Array, axis: int, split: float) -> tuple[tuple[Array, Array, Array], tuple[Array, Array, Array]]:
            below = points[:, axis] < split
            middle_high, middle_low = b.copy(), a.copy()
            middle_high[axis] = middle_low[axis] = split
            return (points[below], a, middle_high), (points[~below], middle_low, b)

        def refine(points: Array, a: Array, b: Array, level: int) -> None:
            """Bisects a cell until its points look uniform in each of its boxes, so that cubature cannot miss where they crowd."""
            crowding = _crowding(points, a, b) if len(points) > 1 and level < 40 else np.zeros_like(a)
            axis = int(np.argmax(crowding))
            if crowding[axis] < 1.2:
                boxes.append((a, b, size))
                return
            for half in halves(points, a, b, axis, 0.5 * (a[axis] + b[axis])):
                refine(*half, level + 1)

        def build(points: Array, a: Array, b: Array, level: int, cuts: list[tuple[int, float]]) -> int:
            nonlocal size
            if not cuts and (level == depth or len(points) < 4):
                refine(points, a, b, 0)
                size += 1
                return -size
            axis, split = cuts[0] if cuts else (level % len(a), float(np.median(points[:, level % len(a)])))
            if not a[axis] < split < b[axis]:
                split = 0.5 * (a[axis] + b[axis])
            node, level = len(tree), level if cuts else level + 1
            tree.append((axis, split, 0, 0))
            below, above = (build(*half, level, cuts[1:]) for half in halves(points, a, b, axis, split))
            tree[node] = (axis, split, below, above)
            return node

        build(np.asarray(pilot, np.float64), np.array(low, np.float64), np.array(high, np.float64), 0, list((cuts or {}).items()))
        axes, splits, *children = zip(*tree, strict=True) if tree else ((), (), (), ())
        lows, highs, owners = zip(*boxes, strict=True)
        return cls(size, np.array(lows), np.array(highs), np.array(owners), np.array(axes, np.int64), np.array(splits), np.array(children).T)

    def __len__(self) -> int:
        return self.size

    def count(self, points: Array) -> Array:
        """How many of the points (n, d) each cell holds."""
        node = np.full(len(points), 0 if len(self._axis) else -1)
        while len(inner := np.flatnonzero(node >= 0)):
            at = node[inner]
            node[inner] = self._children[at, (points[inner, self._axis[at]] >= self._split[at]).astype(np.int64)]
        return np.bincount(-1 - node, minlength=len(self))

    def integrate(self, function: Callable[[Array], Array], tolerance: float = 1e-3) -> tuple[Array, Array]:
        """``integrate`` over every cell: integrals and errors, (cells, k)."""
        values, differences = integrate(function, self.low, self.high, tolerance)
        totals, errors = np.zeros((len(self), values.shape[1])), np.zeros((len(self), values.shape[1]))
        np.add.at(totals, self.owner, values)
        np.add.at(errors, self.owner, differences)
        return totals, errors


SPHERE_LOW, SPHERE_HIGH = np.array([-1.0, -np.pi]), np.array([1.0, np.pi])
"""The sphere as a rectangle of the same area, see ``sphere_to_rectangle``."""


def sphere_to_rectangle(w: Array) -> Array:
    """Unit vectors (n, 3) → (t, φ), (n, 2), with dω = dt dφ: t is 1 − z above the horizon and −(1 + z) below.

    Both poles are at t = 0 and the horizon at t = ±1, so that a narrow lobe about a pole keeps its digits; 1 − |z| is computed from x and y.
    """
    w = np.asarray(w, np.float64)
    from_pole = np.square(w[:, :2]).sum(axis=1) / (1.0 + np.abs(w[:, 2]))
    from_pole = np.where(np.abs(w[:, 2]) < 0.5, 1.0 - np.abs(w[:, 2]), from_pole)
    return np.stack([np.where(w[:, 2] >= 0.0, from_pole, -from_pole), np.arctan2(w[:, 1], w[:, 0])], -1)


def rectangle_to_sphere(t_phi: Array) -> Array:
    """The inverse of ``sphere_to_rectangle``."""
    t, phi = t_phi[:, 0], t_phi[:, 1]
    from_pole = np.abs(t)
    r = np.sqrt(from_pole * (2.0 - from_pole))
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.where(t >= 0.0, 1.0, -1.0) * (1.0 - from_pole)], -1)
