"""The ray–triangle test: exact signs, no gaps, any scale."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from lumiere.accel import Accelerator
from lumiere.accel.flat import Flat
from lumiere.device.source import assemble
from tests.accel.test_traversal import assert_same_hits, every_accelerator, every_tree, lattice, mesh_triangles, rays_around
from tests.accel.tracer import ACCELERATORS, NONE, Tracer
from tests.contexts import context_of


def run(device: cl.Device, body: str, *columns: np.ndarray) -> np.ndarray:
    """A kernel's float ``out`` for each row, its inputs named a, b, c, …; ``triangle_test.cl`` is there."""
    names = "abcdefghi"[: len(columns)]
    parameters = "".join(f"global const float *{name}_, " for name in names)
    loads = "".join(f"float {name} = {name}_[i]; " for name in names)
    kernel = f"kernel void test({parameters}global float *out) {{ size_t i = get_global_id(0); {loads} out[i] = {body}; }}"
    text = assemble("test.cl", "", {"test.cl": "typedef struct { global const float *triangle_vertices; } scene_t;\n"
                                               f'#include "shape/triangle_test.cl"\n{kernel}'})
    context = context_of(device)
    queue, out = cl.CommandQueue(context), np.zeros(len(columns[0]), np.float32)
    flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
    buffers = [cl.Buffer(context, flags, hostbuf=np.ascontiguousarray(c, np.float32)) for c in columns]
    out_d = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, out.nbytes)
    cl.Program(context, text).build().test(queue, out.shape, None, *buffers, out_d)
    cl.enqueue_copy(queue, out, out_d)
    return out


def test_the_sign_of_an_edge_is_exact(device: cl.Device) -> None:
    """Products of floats that differ by less than a float's rounding. In double precision each product is exact."""
    random = np.random.default_rng(0)
    a, b, c = (random.uniform(0.5, 1.0, 200_000).astype(np.float32) for _ in range(3))
    d = (a.astype(np.float64) * b / c).astype(np.float32)
    exact = np.sign(a.astype(np.float64) * b - c.astype(np.float64) * d)
    rounded = np.sign(a * b - c * d)
    assert (rounded != exact).mean() > 0.1, "the case is too easy to tell"
    assert np.array_equal(np.sign(run(device, "triangle_edge(a, b, c, d)", a, b, c, d)), exact)
    assert np.array_equal(run(device, "triangle_edge(c, d, a, b)", a, b, c, d), -run(device, "triangle_edge(a, b, c, d)", a, b, c, d))


def test_the_unit_scale_is_a_power_of_two(device: cl.Device) -> None:
    sizes = np.float32([0.0, 2.0**-126, 1e-30, 0.5, 1.0, 1.5, 3.0, 1e30, 3e38])
    scales = run(device, "triangle_unit_scale(a)", sizes)
    assert (np.frexp(scales)[0] == 0.5).all()
    assert ((sizes[1:] * scales[1:] >= 1.0) & (sizes[1:] * scales[1:] < 4.0)).all()


def winding(triangles: np.ndarray, point: np.ndarray) -> float:
    """How often closed triangles (n, 3, 3) surround ``point``: the sum of their solid angles over 4π (Van Oosterom & Strackee 1983)."""
    a, b, c = np.moveaxis(triangles.astype(np.float64) - point, 1, 0)
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    dots = [(x * y).sum(axis=1) for x, y in ((a, b), (b, c), (c, a))]
    determinant = (a * np.cross(b, c)).sum(axis=1)
    return float(np.arctan2(determinant, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb).sum() / (2 * np.pi))


@every_tree
def test_a_closed_mesh_has_no_gaps(device: cl.Device, tree: Accelerator) -> None:
    """From inside towards every vertex and many points of every edge: each ray has to meet the mesh."""
    triangles = mesh_triangles("spot_closed.ply")
    random = np.random.default_rng(6)
    candidates = random.uniform(triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1)), (60, 3)).astype(np.float32)
    inside = [p for p in candidates if winding(triangles, p) > 0.5]
    assert len(inside) >= 5 and all(abs(winding(triangles, p) - 1.0) < 1e-9 for p in inside)
    weights = random.random((12, 1, 1))
    weights[:2, 0, 0] = 0.0, 0.5
    targets = np.concatenate([triangles + w * (np.roll(triangles, 1, axis=1) - triangles) for w in weights]).reshape(-1, 3)
    tracer = Tracer(device, triangles, tree)
    for origin in inside[:8]:
        directions = (targets - origin).astype(np.float32)
        assert (tracer.nearest(origin, directions)[1] != NONE).all()
        assert tracer.occluded(origin, directions).all()


def test_edges_and_vertices_belong_to_the_triangle(device: cl.Device) -> None:
    """Through points of a lattice that are exact in single precision, from places that are, so that edge functions are exactly 0."""
    points = np.stack(np.meshgrid(np.arange(1, 16, 0.5), np.arange(1, 16, 0.5), [0.0]), axis=-1).reshape(-1, 3)
    plane = lattice()[:512]
    for offset in ((0, 0, 4), (1, 0, 4), (-3, 2, 8), (8, -8, 2), (5, 5, -1)):
        for accelerator in ACCELERATORS:
            hits, primitives = Tracer(device, plane, accelerator).nearest(points + offset, -np.float64(offset) * np.ones_like(points))
            assert (primitives != NONE).all()
            assert (hits[:, 0] == 1.0).all()


@every_accelerator
def test_hits_lie_on_the_triangle(device: cl.Device, accelerator: Accelerator) -> None:
    """Against double precision: the distance from the plane, which no grazing angle worsens, and where the barycentrics say it is."""
    random = np.random.default_rng(8)
    triangles = random.uniform(-1, 1, (300, 3, 3)).astype(np.float32)
    origins, directions = rays_around(triangles, 20_000, random)
    origins, directions = origins.astype(np.float32).astype(np.float64), directions.astype(np.float32).astype(np.float64)
    hits, primitives = Tracer(device, triangles, accelerator).nearest(origins, directions)
    met = primitives != NONE
    assert met.sum() > 5000
    v0, v1, v2 = np.moveaxis(triangles[primitives[met]].astype(np.float64), 1, 0)
    t, u, v = hits[met].astype(np.float64).T[:, :, None]
    point = origins[met] + t * directions[met]
    normal = np.cross(v1 - v0, v2 - v0)
    size = np.abs(np.stack([v0, v1, v2]) - origins[met]).max(axis=(0, 2))
    bound = 16 * 2.0**-24 * size
    assert (np.abs(((point - v0) * normal).sum(axis=1)) / np.linalg.norm(normal, axis=1) <= bound).all()
    assert ((u >= 0) & (v >= 0) & (u + v <= 1 + 4 * 2.0**-24)).all()
    # The barycentric point and the ray's point are both on the plane; seen along the ray they are the same.
    across = np.linalg.norm(np.cross((1 - u - v) * v0 + u * v1 + v * v2 - origins[met], directions[met]), axis=1)
    assert (across / np.linalg.norm(directions[met], axis=1) <= bound).all()


@every_accelerator
@pytest.mark.parametrize("exponent", [-100, -64, -45, -36, 43, 49, 64, 100])
def test_scale_changes_nothing(device: cl.Device, accelerator: Accelerator, exponent: int) -> None:
    """A scene 2^k times as large is met at the same barycentrics and 2^k times the distance, to the bit."""
    random = np.random.default_rng(9)
    triangles = random.uniform(-1, 1, (300, 3, 3)).astype(np.float32)
    origins, directions = (x.astype(np.float32) for x in rays_around(triangles, 5000, random))
    hits, primitives = Tracer(device, triangles, accelerator).nearest(origins, directions)
    scale = np.float32(2.0**exponent)
    scaled = Tracer(device, triangles * scale, accelerator).nearest(origins * scale, directions)
    assert_same_hits(scaled, (hits * np.float32([scale, 1, 1]), primitives))


def test_degenerate_triangles_are_never_met(device: cl.Device) -> None:
    """Three points on a line through the integers, and repeated vertices; rays towards their own points."""
    random = np.random.default_rng(10)
    start, step = random.integers(-8, 9, (400, 1, 3)), random.integers(-4, 5, (400, 1, 3))
    line = (start + step * random.integers(-3, 4, (400, 3, 1))).astype(np.float32)
    corners = random.uniform(-8, 8, (200, 3, 3)).astype(np.float32)
    triangles = np.concatenate([line, corners[:, [0, 1, 1]], corners[:, [0, 1, 0]], corners[:, [2, 2, 2]]])
    origins, directions = rays_around(triangles, 40_000, random)
    vertices = triangles.reshape(-1, 3)
    directions[::2] = vertices[random.integers(len(vertices), size=20_000)] - origins[::2]
    for accelerator in ACCELERATORS:
        assert (Tracer(device, triangles, accelerator).nearest(origins, directions)[1] == NONE).all()


def test_the_interval_is_open(device: cl.Device) -> None:
    """At 0 < t < t_max: not where the ray begins on the triangle, nor at t_max itself."""
    tracer = Tracer(device, np.float32([[[0, 0, 2], [1, 0, 2], [0, 1, 2]]]), Flat())
    origins = np.float32([[0.25, 0.25, 2], [0.25, 0.25, 0], [0.25, 0.25, 0], [0.25, 0.25, 3]])
    t_max = np.float32([np.inf, 2, np.nextafter(np.float32(2), np.float32(3)), np.inf])
    primitives = tracer.nearest(origins, np.float32([[0, 0, 1]] * 4), t_max)[1]
    assert primitives.tolist() == [NONE, NONE, 0, NONE]
