"""Rays through the accelerators: the tree meets what the plain list meets."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from lumiere.accel import Accelerator
from lumiere.accel.build import MAX_DEPTH, Topology
from lumiere.accel.flat import Flat
from lumiere.device.source import assemble, template
from lumiere.wavefront.policy import is_gpu
from tests.accel.tracer import ACCELERATORS, NONE, SHAPE, TREES, Tracer, scene_struct, title, topology_of
from tests.contexts import context_of

ASSETS = Path(__file__).parents[3] / "shared" / "assets"
MESHES = ["alien.glb", "alpha_blend_mode.glb", "flight_helmet/FlightHelmet.gltf", "fuze/fuze.obj", "spot/spot.obj", "spot_closed.ply",
          "spot_valley.glb", "broken/degenerate.ply", "broken/nan_inf.ply", "broken/soup.stl"]
TESTS, TESTS_ON_A_GPU = 3e7, 1e11
"""Triangle tests of the plain list for one mesh: about half a second on two CPU cores; on a GPU all 10⁵ rays meet all triangles of every mesh."""

every_accelerator = pytest.mark.parametrize("accelerator", ACCELERATORS, ids=title)
every_tree = pytest.mark.parametrize("tree", TREES, ids=title)


def mesh_triangles(name: str) -> np.ndarray:
    """(n, 3, 3) float32 of an asset."""
    from lumiere.meshfile import clean, load_mesh

    if not (ASSETS / name).is_file():
        pytest.skip(f"{name} is not here")
    return np.concatenate([part.vertices[clean(part.vertices, part.faces)[0]] for part in load_mesh(ASSETS / name)]).astype(np.float32)


@cache
def topology_over(name: str, tree: int) -> Topology:
    """What a tree's number among TREES builds over an asset, once for all devices."""
    return topology_of(TREES[tree], mesh_triangles(name))


def rays_around(triangles: np.ndarray, n: int, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions (n, 3): from around the triangles and from between them, half of them towards points on triangles."""
    lower, upper = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    origins = random.uniform(lower - 0.5 * (upper - lower), upper + 0.5 * (upper - lower), (n, 3))
    weights = random.dirichlet([1, 1, 1], n)
    targets = np.einsum("nv,nva->na", weights, triangles[random.integers(len(triangles), size=n)])
    directions = np.where(random.random((n, 1)) < 0.5, targets - origins, random.normal(size=(n, 3)))
    return origins, directions


def assert_same_hits(ours: tuple[np.ndarray, np.ndarray], expected: tuple[np.ndarray, np.ndarray]) -> None:
    """Equal to the bit, but for which of several triangles is named where they are met at the same distance."""
    (hits, primitives), (expected_hits, expected_primitives) = ours, expected
    assert np.array_equal(hits[:, 0], expected_hits[:, 0])
    assert np.array_equal(primitives == NONE, expected_primitives == NONE)
    named_alike = primitives == expected_primitives
    assert np.array_equal(hits[named_alike], expected_hits[named_alike])
    assert named_alike.mean() > 0.95


@pytest.mark.parametrize("name", MESHES)
def test_tree_and_list_agree(device: cl.Device, name: str) -> None:
    triangles = mesh_triangles(name)
    n = 100_000
    origins, directions = rays_around(triangles, n, np.random.default_rng(11))
    few = max(16, min(n, int((TESTS_ON_A_GPU if is_gpu(device) else TESTS) / len(triangles))))
    plain = Tracer(device, triangles, Flat())
    expected = plain.nearest(origins[:few], directions[:few])
    assert np.array_equal(plain.occluded(origins[:few], directions[:few]), expected[1] != NONE)
    for accelerator in TREES:
        if accelerator.name == "bvh8" and is_gpu(device):
            continue  # used there only where asked (tests/accel/conftest.py)
        tree = Tracer(device, triangles, accelerator, topology=topology_over(name, TREES.index(accelerator)))
        hits, primitives = tree.nearest(origins, directions)
        assert_same_hits((hits[:few], primitives[:few]), expected)
        met = primitives != NONE
        assert 0.2 < met.mean() < 1.0
        assert np.array_equal(tree.occluded(origins, directions), met)
        # Just short of the hit and just beyond it.
        for factor, hidden in ((1.0, False), (1.0 + 2.0**-23, True)):
            assert (tree.occluded(origins[met], directions[met], hits[met, 0] * np.float32(factor)) == hidden).all()


def lattice() -> np.ndarray:
    """Two triangles on each square of three perpendicular 16 × 16 planes through the integers."""
    u, v = np.meshgrid(np.arange(16.0), np.arange(16.0), indexing="ij")
    w = np.zeros_like(u)
    corners = [np.stack([u + i, v + j, w], axis=-1).reshape(-1, 3) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    plane = np.concatenate([np.stack([corners[0], corners[1], corners[2]], axis=1), np.stack([corners[0], corners[2], corners[3]], axis=1)])
    return np.concatenate([np.roll(plane, axis, axis=2) for axis in range(3)]).astype(np.float32)


@every_tree
def test_rays_along_the_faces_of_boxes(device: cl.Device, tree: Accelerator) -> None:
    """Axis-parallel rays on integers run within the planes of nodes' boxes and through vertices: none gets lost."""
    u, v = (a.ravel() for a in np.meshgrid(np.arange(0, 16.5, 0.5), np.arange(0, 16.5, 0.5)))
    tracer = Tracer(device, lattice(), tree)
    for axis in range(3):
        for height in (-3.0, 20.0):
            origins = np.roll(np.stack([u, v, np.full_like(u, height)], axis=1), axis, axis=1)
            for zero in (0.0, -0.0):
                directions = np.full_like(origins, zero)
                directions[:, (2 + axis) % 3] = -np.sign(height)
                hits, primitives = tracer.nearest(origins, directions)
                assert (primitives != NONE).all()
                # On the border of a plane the ray runs along another plane's border, and may meet its far edge first.
                inside = (u > 0) & (v > 0)
                assert (hits[inside, 0] == abs(height)).all()


@every_tree
def test_rays_with_components_that_are_none_or_next_to_none(device: cl.Device, tree: Accelerator) -> None:
    """Against the list, from near and from far: directions of which one or two components are 0, -0 or so small that they hardly count."""
    random = np.random.default_rng(12)
    triangles = random.uniform(-1, 1, (400, 1, 3)) + random.uniform(-0.3, 0.3, (400, 3, 3))
    triangles[::2, :, 0] = triangles[::2, :1, 0]  # half of them flat along x
    n = 30_000
    _, directions = rays_around(triangles, n, random)
    small = random.choice([0.0, -0.0, 1e-42, -1e-30, 1e-20, -1e-12, 1e-8, 1e-6], (n, 3))
    which = np.arange(3) == random.integers(3, size=(n, 1))
    which |= (np.arange(3) == random.integers(3, size=(n, 1))) & (random.random((n, 1)) < 0.5)
    directions = np.where(which, small, directions)
    targets = np.einsum("nv,nva->na", random.dirichlet([1, 1, 1], n), triangles[random.integers(400, size=n)])
    origins = targets - directions * random.choice([0.1, 1.0, 30.0], (n, 1))
    expected = Tracer(device, triangles, Flat()).nearest(origins, directions)
    assert (expected[1] != NONE).mean() > 0.8
    traced = Tracer(device, triangles, tree)
    assert_same_hits(traced.nearest(origins, directions), expected)
    assert np.array_equal(traced.occluded(origins, directions), expected[1] != NONE)


@every_accelerator
def test_rays_that_are_none_meet_nothing(device: cl.Device, accelerator: Accelerator) -> None:
    random = np.random.default_rng(2)
    tracer = Tracer(device, random.random((500, 3, 3)), accelerator)
    origins, directions = np.full((7 * 6, 3), 0.5), np.tile(random.normal(size=(6, 3)), (7, 1))
    assert (tracer.nearest(origins, directions)[1] != NONE).all()
    for i, bad in enumerate((np.nan, np.inf, -np.inf)):
        for component in range(3):
            rows = 6 * i + component
            directions[rows, component] = bad
            origins[rows + 3, component] = bad
    directions[18:24] = 0.0
    t_max = np.full(42, np.inf)
    t_max[24:30], t_max[30:36], t_max[36:] = np.nan, 0.0, -1.0
    hits, primitives = tracer.nearest(origins, directions, t_max)
    assert (primitives == NONE).all()
    assert not tracer.occluded(origins, directions, t_max).any()
    assert np.array_equal(hits[:, 0], t_max, equal_nan=True)


@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_few_triangles(device: cl.Device, count: int) -> None:
    triangles = np.float32([[[0, 0, z], [1, 0, z], [0, 1, z]] for z in range(1, count + 1)]).reshape(-1, 3, 3)
    for accelerator in ACCELERATORS:
        tracer = Tracer(device, triangles, accelerator)
        hits, primitives = tracer.nearest(np.float32([[0.25, 0.25, 0]] * 2), np.float32([[0, 0, 1], [0, 0, -1]]))
        assert primitives.tolist() == [0 if count else NONE, NONE]
        assert hits[0, 0] == (1.0 if count else np.inf)


def comb(n: int) -> Topology:
    """A tree as deep as it has leaves: each inner node's left child is a leaf of one primitive, its right child the rest."""
    boxes = np.float32([[[0, 0, z], [1, 1, z]] for z in range(n)])
    lower, upper, left, first, count = [boxes[:, 0].min(axis=0)], [boxes[:, 1].max(axis=0)], [1], [0], [n]
    for i in range(n - 1):
        lower += [boxes[i, 0], boxes[i + 1 :, 0].min(axis=0)]
        upper += [boxes[i, 1], boxes[i + 1 :, 1].max(axis=0)]
        left += [-1, 2 * i + 3]
        first += [i, i + 1]
        count += [1, n - i - 1]
    left[-1] = -1
    return Topology(np.float32(lower), np.float32(upper), np.int32(left), np.uint32(first), np.uint32(count), np.arange(n, dtype=np.uint32), n - 1)


@every_tree
def test_the_deepest_tree_there_can_be(device: cl.Device, tree: Accelerator) -> None:
    """A ray that enters every node from its far side defers a child at each level; a missing triangle would tell of a lost one."""
    n = MAX_DEPTH + 1
    triangles = np.float32([[[0, 0, z], [1, 0, z], [0, 1, z]] for z in range(n)])
    tracer = Tracer(device, triangles, tree, topology=comb(n))
    origins = np.full((n, 3), 0.25)
    origins[:, 2] = n
    for origin_z, direction_z in ((n, -1), (-1, 1)):
        origins[:, 2] = origin_z
        _, primitives = tracer.nearest(origins, np.tile([0, 0, direction_z], (n, 1)))
        assert (primitives == (n - 1 if direction_z < 0 else 0)).all()
    # From below each triangle upwards, and off to the side, where only the boxes are met.
    origins[:, 2] = np.arange(n) - 0.5
    _, primitives = tracer.nearest(origins, np.tile([0, 0, 1.0], (n, 1)))
    assert np.array_equal(primitives, np.arange(n))
    origins[:, :2], origins[:, 2] = 0.9, n
    assert (tracer.nearest(origins, np.tile([0, 0, -1.0], (n, 1)))[1] == NONE).all()


@every_accelerator
def test_hidden_primitives_are_passed_through(device: cl.Device, accelerator: Accelerator) -> None:
    """The tracer's ``triangle_counts`` lets every fourth number count; they begin at 6 here."""
    random = np.random.default_rng(4)
    triangles = random.random((400, 3, 3)).astype(np.float32)
    rays = rays_around(triangles, 5000, random)
    unit_order = Tracer(device, triangles, accelerator).order
    visible = np.flatnonzero((np.arange(400) + 6) % 4 == 0)
    seen = Tracer(device, triangles, accelerator, defines="#define VISIBILITY\n", first=6)
    expected = Tracer(device, triangles[unit_order[visible]], Flat())
    hits, primitives = expected.nearest(*rays)
    primitives = np.where(primitives == NONE, NONE, unit_order[visible][np.minimum(primitives, len(visible) - 1)])
    assert_same_hits(seen.nearest(*rays), (hits, primitives))
    assert np.array_equal(seen.occluded(*rays), primitives != NONE)


def test_each_kind_of_shape_has_a_traversal_of_its_own(device: cl.Device) -> None:
    """The templates stand several times in one program, and the kinds share one shrinking hit."""
    other = "#define copy_ray_t triangle_ray_t\n#define copy_prepare triangle_prepare\n#define copy_intersect triangle_intersect\n"
    undefine = "#undef SHAPE\n#undef SHAPE_FIRST\n"
    text = scene_struct({"nodes": "float", "children": "uint", "vertices": "float"}) + SHAPE + template("accel/bvh2.cl") + other
    for layout in ("bvh2", "flat"):
        text += undefine + f"#define SHAPE copy\n#define SHAPE_FIRST 100\n{template(f'accel/{layout}.cl')}#undef copy\n"
        text = text.replace("#undef copy\n", "#define copy_nearest listed_nearest\n#define copy_occluded listed_occluded\n", 1)
    text += """
kernel void build_only(global float *t)
{
    scene_t scene = {0, 0, 0, 0u, 0u};
    ray_t ray;
    ray.o = (float3)(0.0f);
    ray.d = (float3)(0.0f, 0.0f, 1.0f);
    ray.t_max = *t;
    hit_t hit;
    hit.t = *t;
    bool found = triangle_nearest(&scene, &ray, &hit) || copy_nearest(&scene, &ray, &hit) || copy_occluded(&scene, &ray);
    *t = found ? -1.0f : hit.t;
}
"""
    context = context_of(device)
    program = cl.Program(context, assemble("kinds.cl", "", {"kinds.cl": text})).build()
    queue, t = cl.CommandQueue(context), np.float32([7.0])
    buffer = cl.Buffer(context, cl.mem_flags.COPY_HOST_PTR, hostbuf=t)
    program.build_only(queue, (1,), None, buffer)
    cl.enqueue_copy(queue, t, buffer)
    assert t[0] == 7.0
