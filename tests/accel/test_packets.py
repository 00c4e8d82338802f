"""Sixteen rays at once against a list of triangles: they meet what single rays meet, and none slips through between two triangles."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from lumiere.accel import PACKETS_UP_TO, choose, with_packets
from lumiere.accel.flat import Flat
from lumiere.accel.flat16 import Flat16
from lumiere.wavefront.policy import is_gpu
from tests.accel.test_traversal import rays_around
from tests.accel.tracer import NONE, Tracer


@pytest.fixture(autouse=True)
def only_on_cpus(device: cl.Device) -> None:
    if is_gpu(device):
        pytest.skip("packets are for CPUs")


def assert_like_single_rays(device: cl.Device, triangles: np.ndarray, origins: np.ndarray, directions: np.ndarray,
                            t_max: np.ndarray | float = np.inf) -> np.ndarray:
    """The same triangles at the same places, to roundings of the distance; returns what was met."""
    expected, expected_primitives = Tracer(device, triangles, Flat()).nearest(origins, directions, t_max)
    tracer = Tracer(device, triangles, Flat16())
    hits, primitives = tracer.nearest(origins, directions, t_max)
    assert np.array_equal(primitives == NONE, expected_primitives == NONE)
    met = primitives != NONE
    same = met & (primitives == expected_primitives)
    assert same.sum() > 0.99 * met.sum()  # else two lie at the same distance
    distance = np.abs(hits[met, 0] / expected[met, 0] - 1.0)
    assert distance.max() < 2e-3 and np.quantile(distance, 0.99) < 1e-5
    # Barycentrics as exactly as single rays have them, where the triangle is not seen edge on.
    assert np.quantile(np.abs(hits[same, 1:] - expected[same, 1:]), 0.99) < 1e-5
    assert np.array_equal(tracer.occluded(origins, directions, t_max), met)
    return primitives


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("count", [1, 40, PACKETS_UP_TO])
def test_packets_meet_what_single_rays_meet(device: cl.Device, count: int, scale: float) -> None:
    random = np.random.default_rng(count)
    triangles = (scale * random.random((count, 3, 3))).astype(np.float32)
    origins, directions = rays_around(triangles, 5003, random)  # the last packet is not full
    primitives = assert_like_single_rays(device, triangles, origins, directions)
    assert 0.1 < (primitives != NONE).mean() < 1.0
    # Directions of any length: t counts them.
    assert_like_single_rays(device, triangles, origins, directions * 1e3, random.uniform(0.0, 2e-3, len(origins)))


def parallelograms(count: int, random: np.random.Generator) -> np.ndarray:
    """(2 count, 3, 3) float32: a, b, c and a, c, d, on a grid where a + c = b + d is exact."""
    a, b, d = np.moveaxis(random.integers(-64, 64, (count, 3, 3)) / 64.0, 1, 0)
    c = b + d - a
    return np.stack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)], axis=1).reshape(-1, 3, 3).astype(np.float32)


def test_parallelograms_are_met_as_their_triangles(device: cl.Device) -> None:
    random = np.random.default_rng(9)
    pairs = parallelograms(16, random)
    lone = random.random((5, 3, 3)).astype(np.float32)
    # A fan of three triangles has one parallelogram at most; two in another order, or further apart than by roundings, are none.
    others = parallelograms(5, random)
    a, c, d = others[1]
    others[3, 2] += np.float32(1e-5)
    triangles = np.concatenate([lone[:2], pairs, lone[2:], others[:2], [[a, d, a + d - c]], others[2:4], others[9:3:-1]])
    met_as_one = Flat16().encode(Flat16().build(triangles.min(axis=1), triangles.max(axis=1)), _records(triangles))["planes"][:, 17]
    assert np.flatnonzero(met_as_one).tolist() == [*range(2, 34, 2), 37]
    origins, directions = rays_around(triangles, 20_011, random)
    primitives = assert_like_single_rays(device, triangles, origins, directions)
    assert len(np.unique(primitives)) > 40  # both triangles of nearly all


def test_turned_parallelograms_are_met_as_their_triangles(device: cl.Device) -> None:
    """Whose corners are rounded, far from the origin too: each is off its plane, and off its side."""
    random = np.random.default_rng(10)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    for far in (0.0, 30.0):
        triangles = (parallelograms(30, random).reshape(-1, 3) @ turn + far).astype(np.float32).reshape(-1, 3, 3)
        planes = Flat16().encode(Flat16().build(triangles.min(axis=1), triangles.max(axis=1)), _records(triangles))["planes"]
        assert planes[:, 17].sum() == 30
        a, b, c, d = triangles[0::2, 0], triangles[0::2, 1], triangles[0::2, 2], triangles[1::2, 2]
        assert np.any(a + c != b + d)
        assert_like_single_rays(device, triangles, *rays_around(triangles, 20_011, random))


def _records(triangles: np.ndarray) -> np.ndarray:
    records = np.zeros(len(triangles), [("vertices", np.float32, (3, 3))])
    records["vertices"] = triangles
    return records


def octahedron(turn: np.ndarray) -> np.ndarray:
    """(8, 3, 3) float32, turned by a matrix."""
    corners = np.concatenate([np.eye(3), -np.eye(3)]) @ turn.T
    faces = [(x, y, z) for x in (0, 3) for y in (1, 4) for z in (2, 5)]
    return corners[np.array(faces)].astype(np.float32)


def cube() -> np.ndarray:
    """(12, 3, 3) float32, two and two a parallelogram."""
    x, y, z = np.eye(3)
    faces = [(side * n, a, b) for n, a, b in ((x, y, z), (y, z, x), (z, x, y)) for side in (-1.0, 1.0)]
    corners = [(m - a - b, m + a - b, m + a + b, m - a + b) for m, a, b in faces]
    return np.float32([[[p, q, r], [p, r, s]] for p, q, r, s in corners]).reshape(-1, 3, 3)


@pytest.mark.parametrize("body", ["octahedron", "cube"])
def test_no_ray_slips_out_between_triangles(device: cl.Device, body: str) -> None:
    """From inside a closed body towards its edges and vertices, to the float: every ray meets it."""
    random = np.random.default_rng(5)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    triangles = octahedron(turn) if body == "octahedron" else cube()
    n = 200_000
    at = random.integers(len(triangles), size=n), random.integers(3, size=n)
    start, end = triangles[at], triangles[at[0], (at[1] + 1) % 3]
    along = random.choice([0.0, 0.25, 0.5, 1.0], (n, 1)) * random.choice([1.0, 0.37], (n, 1))
    origins = random.choice([0.0, 0.1], (n, 1)) * random.normal(size=(n, 3))
    origins = origins.astype(np.float32)
    directions = (start + along * (end - start)).astype(np.float32) - origins
    tracer = Tracer(device, triangles, Flat16())
    assert (tracer.nearest(origins, directions)[1] != NONE).all()
    assert tracer.occluded(origins, directions).all()


def test_rays_that_are_none_and_rays_from_the_surface_meet_nothing(device: cl.Device) -> None:
    triangles = np.float32([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [1, 0, 1], [0, 1, 1]]])
    up = [0.0, 0.0, 1.0]
    origins = np.float32([[0.25, 0.25, 0.0], [np.nan, 0.25, 0.5], [0.25, 0.25, 0.5], [0.25, 0.25, 0.5], [0.25, 0.25, 0.5], [0.25, 0.25, 0.5]])
    directions = np.float32([up, up, [np.inf, 0, 1], [0, 0, 0], up, up])
    t_max = np.float32([np.inf, np.inf, np.inf, np.inf, np.nan, 0.25])
    tracer = Tracer(device, triangles, Flat16())
    assert tracer.nearest(origins, directions, t_max)[1].tolist() == [1, NONE, NONE, NONE, NONE, NONE]
    assert tracer.occluded(origins, directions, t_max).tolist() == [True, False, False, False, False, False]


def test_packets_are_for_few_triangles_and_wide_vectors() -> None:
    packed = with_packets(choose)
    assert packed("triangle", PACKETS_UP_TO, bounded=True, wide=True).name == "flat16"
    for shape, count, bounded, wide in (("triangle", PACKETS_UP_TO + 1, True, True), ("triangle", 3, True, False), ("sphere", 3, True, True)):
        assert packed(shape, count, bounded, wide).name == choose(shape, count, bounded, wide).name
