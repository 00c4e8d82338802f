"""Trees that the device builds: as good as numpy's, the same however the work is dealt out, and encoded as documented."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np
import pyopencl as cl
import pytest

from lumiere.accel import Accelerated
from lumiere.accel.build import FEW, Topology, build, half_area
from lumiere.accel.bvh2 import Bvh2
from lumiere.accel.bvh8 import WIDTH, Bvh8
from lumiere.accel.cwbvh import Cwbvh, leaves_together
from lumiere.accel.device_build import Grain
from lumiere.accel.flat import Flat
from lumiere.accel.on_device import FROM_ON_CPU, FROM_ON_GPU, DeviceLayout, OnDevice, on_device
from lumiere.shape.triangle import Triangle
from lumiere.wavefront.policy import is_gpu
from tests.accel.test_build import check
from tests.accel.test_encode import compressed_leaves, leaves_of, wide_nodes, wide_nodes_of
from tests.accel.test_traversal import assert_same_hits, mesh_triangles, rays_around
from tests.accel.tracer import NONE, Tracer
from tests.contexts import context_of

GRAINS = {"alone": Grain(group=1, chunk=500, small=100, span=64), "groups": Grain(group=64, chunk=512, small=FEW, span=32), "own": None}
LAYOUTS: list[DeviceLayout] = [Bvh2(), Bvh8(), Cwbvh()]

every_layout = pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: layout.name)


@cache
def accelerator(device: cl.Device, layout: DeviceLayout, grain: str) -> OnDevice:
    context = context_of(device)
    made = OnDevice(layout, context, cl.CommandQueue(context))
    made.builder.grain = GRAINS[grain]
    made.builder.shares_memory = False if grain == "groups" else None
    return made


def accelerated(device: cl.Device, layout: DeviceLayout, grain: str, triangles: np.ndarray) -> tuple[Accelerated, Topology, np.ndarray]:
    """What the device made of triangles (n, 3, 3); the tree that it is of, as numpy's encoders take it; and records in the tree's order."""
    made = accelerator(device, layout, grain)
    records = np.zeros(len(triangles), Triangle.record)
    records["vertices"] = triangles
    tree = made.builder.build(*Triangle.bounds(records))
    return made.accelerate(Triangle, records), made.builder.topology(tree), records[np.asarray(tree.order)]


def cost(topology: Topology, block: int) -> float:
    """The expected cost that the builders minimise, as `sah_cost` but by blocks."""
    area = half_area(topology.lower.T, topology.upper.T)
    blocks = np.where(topology.leaves, -(-topology.count.astype(np.int64) // block), 1)
    return float(area @ blocks / area[0])


def box_sets() -> Iterator[tuple[str, np.ndarray, np.ndarray, bool]]:
    """Name, boxes, and whether the cost is to be compared."""
    random = np.random.default_rng(4)
    for n in (9, FEW + 1, 5000, 20_000):
        lower = random.random((n, 3)).astype(np.float32)
        yield f"{n} at random", lower, lower + np.float32(0.01), True
    sizes = random.lognormal(-5.0, 2.0, (4000, 3)).astype(np.float32)
    lower = random.random((4000, 3)).astype(np.float32)
    yield "of many sizes", lower, lower + sizes, True
    lower = np.full((5000, 3), 0.25, np.float32)
    yield "identical", lower, lower + 1, True
    lower = random.integers(-3, 4, (5000, 3)).astype(np.float32)
    yield "duplicates", lower, lower + random.integers(0, 3, (5000, 3)).astype(np.float32), True
    x, y = np.meshgrid(np.arange(64), np.arange(64))
    lower = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3).astype(np.float32)
    yield "flat", lower, lower + np.float32([1, 1, 0]), True
    lower = (2.0 ** np.linspace(-100, 100, 4000)[:, None] * np.ones(3)).astype(np.float32)
    yield "too deep for a plane", lower, lower, True
    for scale in (1e-45, 1e-38, 1e-30, 1e30, 3e38):
        corners = random.uniform(-1, 1, (3000, 2, 3)) * scale
        # Below 1e-37 no bin has a width: there numpy sorts centroids to halve them, and the device does not.
        yield f"of {scale:g}", corners.min(axis=1).astype(np.float32), corners.max(axis=1).astype(np.float32), scale > 1e-37


BOX_SETS = {name: rest for name, *rest in box_sets()}


@every_layout
@pytest.mark.parametrize("name", BOX_SETS)
def test_as_good_as_numpys_and_always_the_same(device: cl.Device, layout: DeviceLayout, name: str) -> None:
    lower, upper, compared = BOX_SETS[name]
    built = []
    for grain in [*GRAINS, "groups", "own"]:
        builder = accelerator(device, layout, grain).builder
        tree = builder.build(lower, upper)
        assert np.array_equal(tree.low, lower.min(axis=0)) and np.array_equal(tree.high, upper.max(axis=0))
        built.append(builder.topology(tree))
        assert np.array_equal(built[-1].order, built[0].order)
        assert cost(built[-1], layout.block) == pytest.approx(cost(built[0], layout.block), rel=1e-6)
    check(built[0], lower, upper, layout.max_leaf_size)
    if compared:  # the same splits, but where several are as good
        assert cost(built[0], layout.block) == pytest.approx(cost(layout.build(lower, upper), layout.block), rel=1e-4)


def scattered(n: int) -> np.ndarray:
    """(n, 3, 3) small triangles, some of them the same."""
    random = np.random.default_rng(n)
    triangles = random.random((n, 1, 3)) + random.normal(0.0, 0.01, (n, 3, 3))
    triangles[: n // 10] = triangles[0]
    return triangles.astype(np.float32)


@pytest.mark.parametrize("grain", GRAINS)
@pytest.mark.parametrize("n", [9, 100, 20_000])
def test_bvh2_as_numpy_encodes_it(device: cl.Device, grain: str, n: int) -> None:
    made, topology, records = accelerated(device, LAYOUTS[0], grain, scattered(n))
    assert np.array_equal(made.order, topology.order) and np.array_equal(np.asarray(made.records), records)
    arrays, expected = {name: np.asarray(array) for name, array in made.arrays.items()}, Bvh2().encode(topology, np.zeros(0))
    assert {name: (a.dtype, a.shape) for name, a in arrays.items()} == {name: (a.dtype, a.shape) for name, a in expected.items()}
    assert all(np.array_equal(arrays[name], expected[name]) for name in expected)
    assert sum(count for _, count, _ in leaves_of(arrays)) == n


@pytest.mark.parametrize("grain", GRAINS)
@pytest.mark.parametrize("n", [9, 100, 20_000])
def test_bvh8_is_as_good_as_numpys(device: cl.Device, grain: str, n: int) -> None:
    """The same blocks, and wide nodes of the same area in all; their numbers are another walk's."""
    made, topology, records = accelerated(device, LAYOUTS[1], grain, scattered(n))
    arrays, expected = {name: np.asarray(array) for name, array in made.arrays.items()}, Bvh8().encode(topology, records)
    assert {name: (a.dtype, a.shape[1:]) for name, a in arrays.items()} == {name: (a.dtype, a.shape[1:]) for name, a in expected.items()}
    places = [np.argsort(a["blocks"][:, 9, 0].view(np.uint32) & (1 << 28) - 1) for a in (arrays, expected)]
    assert np.array_equal(places[0], np.arange(len(places[0]))), "blocks lie in the order of their triangles"
    assert np.array_equal(arrays["blocks"].view(np.uint32), expected["blocks"][places[1]].view(np.uint32))
    ours, theirs = wide_nodes_of(arrays), wide_nodes(topology)
    assert sum(area for area, _ in ours) == pytest.approx(sum(area for area, _ in theirs), rel=1e-4)
    if n > 10_000:
        assert np.mean([children for _, children in ours]) > 0.65 * WIDTH and n > 0.65 * WIDTH * len(arrays["blocks"])


@pytest.mark.parametrize("grain", GRAINS)
@pytest.mark.parametrize(("n", "scale"), [(9, 1.0), (100, 1e-30), (5000, 1.0), (20_000, 3e38)])
def test_cwbvh_is_as_good_as_numpys(device: cl.Device, grain: str, n: int, scale: float) -> None:
    """Wide nodes of as many children, and leaves in boxes no wider than numpy's but for a rounding."""
    triangles = scattered(n)
    triangles = np.clip(2.0 * triangles - 1.0, -1.0, 1.0)
    # What lies 2^-40 beyond a step of the grid from the corner −1 differs from it by a number of steps, in single precision.
    triangles[:4] = np.array([-1.0, 1.0, -(2.0**-40), 2.0**-40])[:, None, None]
    triangles = (np.float32(scale) * triangles).astype(np.float32)
    made, topology, _ = accelerated(device, LAYOUTS[2], grain, triangles)
    arrays, numpys = {"nodes": np.asarray(made.arrays["nodes"])}, leaves_together(topology)
    expected = Cwbvh().encode(numpys, np.zeros(0))
    assert np.array_equal(np.asarray(made.records)["vertices"], triangles[made.order])
    assert arrays["nodes"].dtype == np.uint32 and len(arrays["nodes"]) == pytest.approx(len(expected["nodes"]), rel=0.01)
    sizes = []
    for found, order in ((compressed_leaves(arrays), made.order), (compressed_leaves(expected), numpys.order)):
        held, size = np.zeros(n, int), 0.0
        for first, count, box in found:
            members = order[first : first + count]
            held[members] += 1
            assert (box[0] <= triangles[members].min(axis=(0, 1))).all() and (box[1] >= triangles[members].max(axis=(0, 1))).all()
            size += float((box[1] / scale - box[0] / scale).sum())
        assert (held == 1).all()
        sizes.append(size)
    assert sizes[0] == pytest.approx(sizes[1], rel=0.01)


@every_layout
@pytest.mark.parametrize("name", ["scattered", "spot/spot.obj", "broken/soup.stl"])
def test_rays_meet_what_they_meet_in_a_list(device: cl.Device, layout: DeviceLayout, name: str) -> None:
    if layout.name == "bvh8" and is_gpu(device):
        pytest.skip("an eight-wide tree is for CPUs")
    triangles = scattered(3000) if name == "scattered" else mesh_triangles(name)
    if len(triangles) <= layout.max_leaf_size:
        pytest.skip("a leaf holds them all")
    origins, directions = rays_around(triangles, 5000, np.random.default_rng(12))
    expected = Tracer(device, triangles, Flat()).nearest(origins, directions)
    for grain in ("alone", "groups"):
        tracer = Tracer(device, triangles, accelerator(device, layout, grain))
        if name != "scattered":
            assert_same_hits(tracer.nearest(origins, directions), expected)
        assert np.array_equal(tracer.nearest(origins, directions)[0], expected[0])
        assert np.array_equal(tracer.occluded(origins, directions), expected[1] != NONE)


def test_a_handful_is_left_to_numpy(device: cl.Device) -> None:
    context = context_of(device)
    made = OnDevice(Bvh8(), context, cl.CommandQueue(context))
    arrays = made.accelerate(Triangle, np.zeros(8, Triangle.record)).arrays
    assert isinstance(arrays["blocks"], np.ndarray) and len(arrays["blocks"]) == 1


@pytest.mark.parametrize("error", [cl.MemoryError, cl.RuntimeError])
def test_where_the_device_has_no_room_the_host_builds(device: cl.Device, monkeypatch: pytest.MonkeyPatch, error: type[Exception]) -> None:
    def no_room(*arguments: object) -> None:
        raise error("no room")

    context = context_of(device)
    made = OnDevice(Bvh2(), context, cl.CommandQueue(context))
    monkeypatch.setattr(made.builder, "allocate", no_room)
    records = np.zeros(100, Triangle.record)
    records["vertices"] = scattered(100)
    built, expected = made.accelerate(Triangle, records), Bvh2().accelerate(Triangle, records)
    assert isinstance(built.arrays["nodes"], np.ndarray) and np.array_equal(built.arrays["nodes"], expected.arrays["nodes"])
    assert np.array_equal(built.order, expected.order)


def test_who_builds(device: cl.Device) -> None:
    context = context_of(device)
    queue, least = cl.CommandQueue(context), FROM_ON_GPU if is_gpu(device) else FROM_ON_CPU

    def builds(n: int, wanted: bool | None = None) -> bool:
        return isinstance(on_device(lambda *_: Bvh2(), context, queue, wanted)("triangle", n, True, False), OnDevice)

    assert (builds(least - 1), builds(least), builds(10, True), builds(least, False), builds(1 << 28)) == (False, True, True, False, False)
    assert isinstance(on_device(lambda *_: Flat(), context, queue, True)("plane", least, False, False), Flat)


def test_numpys_builder_is_not_called(device: cl.Device, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor does a picture change by who builds the tree: with corners, several objects that shine and another shape."""
    import lumiere
    from lumiere.overrides import Overrides
    from lumiere.rendering import Render

    triangles = scattered(500) * 2.0 - 1.0
    mesh = {"type": "mesh", "vertices": triangles.reshape(-1, 3).tolist(), "faces": np.arange(1500).reshape(-1, 3).tolist()}
    smooth = mesh | {"normals": np.random.default_rng(5).normal(size=(1500, 3)).tolist(), "transform": [{"translate": [0.3, 0, 0.5]}], "emission": 0.5}
    balls = [{"type": "sphere", "position": [x, 1.2, 0], "radius": 0.1, "emission": 1.0 + x} for x in np.linspace(-1, 1, 12).tolist()]
    scene = lumiere.load({"scene": {"camera": {"position": [0, 0, 4]}, "film": {"width": 16, "height": 16, "aovs": ["normal", "object_id"]},
                                    "sampler": {"spp": 2}, "geometry": [mesh, smooth, *balls], "lights": [{"type": "environment", "radiance": 1.0}]}})
    pictures: list[np.ndarray] = []
    arrays: list[dict[str, np.ndarray]] = []
    for wanted in (False, True):
        if wanted:
            monkeypatch.setattr("lumiere.accel.bvh2.build", None)
            monkeypatch.setattr("lumiere.accel.bvh8.build", None)
        job = Render(scene, device.name.strip(), overrides=Overrides(build_on_device=wanted))
        job.run()
        image = job.image({})
        pictures.append(np.concatenate([image.pixels, image.aovs["normal"], image.aovs["object_id"][..., None]], axis=-1))
        arrays.append({name: np.asarray(array) for name, (_, array) in job.wavefront.buffers.arrays.items()})
    assert np.array_equal(*pictures) and pictures[0].std() > 0.01
    assert {name: (a.dtype, a.shape[1:]) for name, a in arrays[0].items()} == {name: (a.dtype, a.shape[1:]) for name, a in arrays[1].items()}


def test_numpy_and_device_agree_on_who_is_where(device: cl.Device) -> None:
    """With blocks no rounding decides: the order of the primitives is numpy's."""
    lower = np.random.default_rng(3).random((20_000, 3)).astype(np.float32)
    tree = accelerator(device, LAYOUTS[1], "own").builder.build(lower, lower + np.float32(0.01))
    assert np.array_equal(np.asarray(tree.order), build(lower, lower + np.float32(0.01), WIDTH, block=WIDTH).order)
