"""What the encoders write, read back."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from lumiere.accel import FLAT_UP_TO, choose, layouts, names, preferring
from lumiere.accel.build import MAX_DEPTH, Topology, build, half_area
from lumiere.accel.bvh2 import Bvh2
from lumiere.accel.bvh8 import Bvh8
from lumiere.accel.collapse import WIDTH
from lumiere.accel.cwbvh import Cwbvh, by_octant
from lumiere.accel.flat import Flat
from lumiere.errors import UsageError
from lumiere.paths import cl_root

RECORDS = np.zeros(0)
"""These encoders write boxes only."""


def leaves_of(arrays: dict[str, np.ndarray]) -> list[tuple[int, int, np.ndarray]]:
    """First primitive, count and box (2, 3) of every leaf that has a box, in the order of a depth-first walk that checks the boxes above."""
    everywhere = np.float32([[-np.inf] * 3, [np.inf] * 3])
    found, waiting = [], [(0, everywhere)]
    while waiting:
        node, outer = waiting.pop()
        xy, z = arrays["nodes"][node, :8].reshape(2, 2, 2), arrays["nodes"][node, 8:].reshape(2, 1, 2)
        boxes = np.concatenate([xy, z], axis=1).transpose(0, 2, 1)  # child, low or high, axis
        for box, child in reversed(list(zip(boxes, arrays["children"][node].tolist(), strict=True))):
            if (box[0] > box[1]).all():
                continue
            assert (box[0] >= outer[0]).all() and (box[1] <= outer[1]).all()
            if child >> 31:
                found.append((child & (1 << 28) - 1, (child >> 28 & 7) + 1, box))
            else:
                waiting.append((child, box))
    return found


@pytest.mark.parametrize("n", [0, 1, 2, 4, 5, 100, 5000])
def test_bvh2_holds_every_primitive_once(n: int) -> None:
    lower = np.random.default_rng(n).random((n, 3)).astype(np.float32)
    upper = lower + np.float32(0.01)
    topology = Bvh2().build(lower, upper)
    arrays = Bvh2().encode(topology, RECORDS)
    assert arrays["nodes"].dtype == np.float32 and arrays["nodes"].shape == (len(arrays["children"]), 12)
    assert arrays["children"].dtype == np.uint32 and arrays["children"].shape[1] == 2
    held = np.zeros(n, int)
    for first, count, box in leaves_of(arrays):
        held[first : first + count] += 1
        members = topology.order[first : first + count]
        assert np.array_equal(box[0], lower[members].min(axis=0)) and np.array_equal(box[1], upper[members].max(axis=0))
    assert (held == 1).all()


def test_a_left_child_follows_its_parent() -> None:
    lower = np.random.default_rng(1).random((1000, 3)).astype(np.float32)
    left = Bvh2().encode(build(lower, lower), RECORDS)["children"][:, 0].astype(np.int64)
    inner = left >> 31 == 0
    assert inner.sum() > 100
    assert np.array_equal(left[inner], np.flatnonzero(inner) + 1)


def test_what_a_reference_cannot_hold_is_refused() -> None:
    lower = np.zeros((9, 3), np.float32)
    topology = build(lower, lower, max_leaf_size=9)
    with pytest.raises(ValueError, match="a leaf of 9 primitives, expected at most 8"):
        Bvh2().encode(topology, RECORDS)
    too_many = np.broadcast_to(np.uint32(0), (1 << 28) + 1)
    with pytest.raises(ValueError, match="found 268435457 primitives, expected at most 268435456"):
        Bvh2().encode(replace(topology, order=too_many), RECORDS)


@pytest.mark.parametrize(("file", "name", "entries_a_level"), [("bvh2_stack", "BVH2_STACK", 1), ("bvh8_node", "BVH8_STACK", WIDTH - 1),
                                                               ("cwbvh", "CWBVH_STACK", 1)])
def test_the_stack_is_as_deep_as_a_tree_may_be(file: str, name: str, entries_a_level: int) -> None:
    text = (cl_root() / f"accel/{file}.cl").read_text(encoding="utf-8")
    assert int(re.search(rf"#define {name} (\d+)", text)[1]) >= MAX_DEPTH * entries_a_level


def test_flat_keeps_the_order_and_takes_infinite_boxes() -> None:
    lower = np.full((3, 3), -np.inf, np.float32)
    topology = Flat().build(lower, -lower)
    assert topology.order.tolist() == [0, 1, 2] and Flat().encode(topology, RECORDS) == {}


def test_choose() -> None:
    assert choose("triangle", FLAT_UP_TO, bounded=True, wide=True).name == "flat"
    assert choose("triangle", FLAT_UP_TO + 1, bounded=True, wide=True).name == "bvh8"
    assert choose("triangle", FLAT_UP_TO + 1, bounded=True, wide=False).name == "bvh2"
    assert choose("sphere", FLAT_UP_TO + 1, bounded=True, wide=True).name == "bvh2"
    assert choose("plane", 1000, bounded=False, wide=True).name == "flat"


def test_every_layout_can_be_preferred() -> None:
    assert set(layouts()) == {"flat", "bvh2", "bvh8", "cwbvh"}
    assert set(names()) == {*layouts(), "bvh2_spatial", "bvh8_spatial"}
    for name, layout in layouts().items():
        assert (cl_root() / f"accel/{name}.cl").is_file()
        for wide in (False, True):
            assert preferring(name)("triangle", 100, bounded=True, wide=wide).name == name
            assert preferring(name)("sphere", 100, bounded=True, wide=wide).name == ("bvh2" if layout.triangles_only else name)
            assert preferring(name)("plane", 100, bounded=False, wide=wide).name == "flat"
    with pytest.raises(UsageError, match="found the accelerator 'bvh3', expected one of bvh2, bvh2_spatial, bvh8, bvh8_spatial, cwbvh, flat"):
        preferring("bvh3")


def wide_nodes(topology: Topology) -> list[tuple[float, int]]:
    """Area and number of children of every wide node of ``Bvh8``, by a walk that checks that each leaf is held once and lies in its box."""
    vertices = np.zeros((len(topology.order), 3, 3), np.float32)
    return wide_nodes_of(Bvh8().encode(topology, np.rec.fromarrays([vertices], names="vertices")))


def wide_nodes_of(arrays: dict[str, np.ndarray]) -> list[tuple[float, int]]:
    """The same of an encoder's arrays."""
    found, waiting, blocks = [], [0], []
    while waiting:
        node = waiting.pop()
        planes = arrays["nodes"][node, :6].view(np.float32)
        low, high = planes[0::2], planes[1::2]
        present = np.isfinite(low[0])
        children = arrays["nodes"][node, 6, present].tolist()
        box = half_area(low[:, present].min(axis=1)[:, None], high[:, present].max(axis=1)[:, None])
        found.append((float(box[0]), len(children)))
        blocks += [child & ~(1 << 31) for child in children if child >> 31]
        waiting += [child for child in children if not child >> 31]
    assert sorted(blocks) == list(range(len(arrays["blocks"]))) and len(found) == len(arrays["nodes"])
    return found


def least_area(topology: Topology, node: int, children: int) -> float:
    """The least area of wide nodes below a binary node that may stand for so many children, by trying everything."""
    if topology.left[node] < 0:
        return 0.0
    left = int(topology.left[node])
    ways = [least_area(topology, left, k) + least_area(topology, left + 1, children - k) for k in range(1, children)]
    if children < WIDTH:
        area = float(half_area(topology.lower[node][:, None], topology.upper[node][:, None])[0])
        ways.append(area + least_area(topology, node, WIDTH))
    return min(ways)


@pytest.mark.parametrize("seed", range(8))
def test_wide_nodes_have_the_least_area(seed: int) -> None:
    random = np.random.default_rng(seed)
    lower = random.random((int(random.integers(2, 16)), 3)).astype(np.float32)
    topology = build(lower, lower + random.random(lower.shape).astype(np.float32), 1)
    root = float(half_area(topology.lower[0][:, None], topology.upper[0][:, None])[0])
    assert sum(area for area, _ in wide_nodes(topology)) == pytest.approx(root + least_area(topology, 0, WIDTH), rel=1e-5)


def test_wide_nodes_and_blocks_are_well_filled() -> None:
    lower = np.random.default_rng(5).random((20000, 3)).astype(np.float32)
    topology = Bvh8().build(lower, lower + np.float32(0.01))
    filled = [children for _, children in wide_nodes(topology)]
    assert np.mean(filled) > 0.65 * WIDTH
    assert len(lower) > 0.8 * WIDTH * np.count_nonzero(topology.leaves)


def compressed_leaves(arrays: dict[str, np.ndarray]) -> list[tuple[int, int, np.ndarray]]:
    """First primitive, count and box (2, 3) of every leaf of ``Cwbvh``, the box in float64, by a walk that visits each node once."""
    nodes = arrays["nodes"]
    parts = nodes.view(np.uint8)
    found, waiting, visited = [], [0], 0
    while waiting:
        node = waiting.pop()
        visited += 1
        corner = nodes[node, :3].view(np.float32)
        step = (parts[node, 12:15].astype(np.uint32) << 23).view(np.float32)
        boxes = corner[:, None].astype(np.float64) + parts[node, 32:].reshape(2, 3, 8) * step[:, None].astype(np.float64)
        rank = 0
        for slot, meta in enumerate(parts[node, 24:32].tolist()):
            place = meta & 31
            assert bool(parts[node, 15] >> slot & 1) == (place >= 24)
            if place >= 24:
                assert meta == 1 << 5 | 24 + slot
                waiting.append(int(nodes[node, 4]) + rank)
                rank += 1
            elif meta:
                found.append((int(nodes[node, 5]) + place, (meta >> 5).bit_count(), boxes[:, :, slot]))
    assert visited == len(nodes)
    return found


@pytest.mark.parametrize("n", [1, 2, 4, 5, 100, 5000])
@pytest.mark.parametrize("scale", [1e-30, 1.0, 1e30])
def test_cwbvh_holds_every_primitive_once_in_a_box_that_holds_it(n: int, scale: float) -> None:
    random = np.random.default_rng(n)
    lower = (scale * random.uniform(-1, 1, (n, 3))).astype(np.float32)
    upper = lower + (scale * 0.01 * random.random((n, 3)) * random.integers(0, 2, (n, 3))).astype(np.float32)  # some are flat
    topology = Cwbvh().build(lower, upper)
    assert np.array_equal(np.sort(topology.order), np.arange(n))
    arrays = Cwbvh().encode(topology, RECORDS)
    assert arrays["nodes"].dtype == np.uint32 and arrays["nodes"].shape[1] == 20
    held = np.zeros(n, int)
    for first, count, box in compressed_leaves(arrays):
        held[first : first + count] += 1
        members = topology.order[first : first + count]
        low, high = lower[members].min(axis=0), upper[members].max(axis=0)
        slack = 2.0**-23 * (high - arrays["nodes"][0, :3].view(np.float32))  # what the device allows for the rounding of the decoded box
        assert (box[0] <= low + slack).all() and (box[1] >= high - slack).all()
    assert (held == 1).all()


def test_cwbvh_boxes_are_tight() -> None:
    """No more than a step of the node's grid wider than what they hold, on each side."""
    lower = np.random.default_rng(1).random((3000, 3)).astype(np.float32)
    topology = Cwbvh().build(lower, lower)
    nodes = Cwbvh().encode(topology, RECORDS)["nodes"]
    largest_step = (nodes.view(np.uint8)[:, 12:15].max(axis=0).astype(np.uint32) << 23).view(np.float32)
    assert (largest_step <= 2.0 / 255.0).all()
    for first, count, box in compressed_leaves({"nodes": nodes}):
        members = lower[topology.order[first : first + count]]
        assert (members.min(axis=0) - box[0] < largest_step).all() and (box[1] - members.max(axis=0) < largest_step).all()


def test_children_lie_in_the_slots_of_their_octants() -> None:
    """The eight unit cubes of a cube of edge 2: the slot's bits say on which side each is."""
    lower = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3).astype(np.float32)
    lower = lower[np.random.default_rng(3).permutation(8)]
    topology = build(lower, lower + 1, 1)
    leaves = np.flatnonzero(topology.leaves)
    slots = by_octant(topology, leaves[None].astype(np.int64))[0]
    assert np.array_equal(topology.lower[slots] @ [4, 2, 1], np.arange(8))
    few = by_octant(topology, np.where(np.arange(8) < 3, leaves, -1)[None].astype(np.int64))[0]
    assert sorted(few[few >= 0]) == sorted(leaves[:3])


def test_cwbvh_refuses_what_it_cannot_hold() -> None:
    lower = np.random.default_rng(1).random((500, 3)).astype(np.float32)
    with pytest.raises(ValueError, match="a leaf of 4 primitives, expected at most 3"):
        Cwbvh().encode(build(np.zeros((4, 3)), np.zeros((4, 3)), max_leaf_size=4), RECORDS)
    with pytest.raises(ValueError, match="found a node's leaves apart"):
        Cwbvh().encode(build(lower, lower, max_leaf_size=3), RECORDS)
