"""The builder with spatial splits: nothing of a triangle is lost, and what overlaps costs less."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lumiere.accel import Choice, choose, layouts, preferring, spatial
from lumiere.accel.build import MAX_DEPTH, Topology, build, sah_cost
from lumiere.accel.cwbvh import Cwbvh
from lumiere.accel.flat import Flat
from lumiere.accel.spatial import SpatialSplits, slices, with_spatial_splits
from lumiere.film.image import Image
from lumiere.overrides import Overrides
from lumiere.rendering import Render
from lumiere.scene.load import load
from lumiere.scene.model import Scene
from lumiere.wavefront.policy import is_gpu
from tests.accel.test_traversal import assert_same_hits, rays_around
from tests.accel.tracer import NONE, TREES, Tracer, title, topology_of

WEIGHTS = np.random.default_rng(0).dirichlet([1, 1, 1], 40)
POINTS = np.concatenate([WEIGHTS, np.eye(3), 0.5 * np.eye(3) + 0.5 * np.roll(np.eye(3), 1, axis=0)])
"""Barycentrics of points on a triangle: within, the vertices, the middles of the edges."""


SIDES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
"""Two triangles on each side of a box, whose corners are numbered by their bits."""


def beams(n: int, seed: int) -> np.ndarray:
    """(12 n, 3, 3): boxes of 2 × 0.02 × 0.02 m in all directions, centres within a cube of 2 m."""
    random = np.random.default_rng(seed)
    turns = np.linalg.qr(random.normal(size=(n, 3, 3)))[0]
    corners = (np.arange(8)[:, None] >> np.arange(3) & 1) * 2.0 - 1.0
    return (((corners * [1.0, 0.01, 0.01]) @ turns + random.uniform(-1, 1, (n, 1, 3)))[:, SIDES].reshape(-1, 3, 3)).astype(np.float32)


def check(topology: Topology, triangles: np.ndarray, max_leaf_size: int) -> None:
    """Every point of every triangle is in the box of a leaf that holds it; ranges, boxes and depth are what they have to be."""
    n = len(triangles)
    assert np.array_equal(np.sort(topology.order), np.arange(n))
    held = topology.order if topology.references is None else topology.order[topology.references]
    assert topology.references is None or n < len(held) <= spatial.MOST_REFERENCES * n + 1
    inner = np.flatnonzero(~topology.leaves)
    left, right = topology.left[inner], topology.left[inner] + 1
    assert np.array_equal(topology.first[left], topology.first[inner])
    assert np.array_equal(topology.first[right], topology.first[left] + topology.count[left])
    assert np.array_equal(topology.count[inner], topology.count[left] + topology.count[right])
    for child in (left, right):
        assert (topology.lower[child] >= topology.lower[inner]).all() and (topology.upper[child] <= topology.upper[inner]).all()
    assert (topology.first[0], topology.count[0]) == (0, len(held)) and topology.depth <= MAX_DEPTH
    points = np.einsum("pv,nva->npa", POINTS, triangles.astype(np.float64))
    covered = np.zeros((n, len(POINTS)), bool)
    for leaf in np.flatnonzero(topology.leaves):
        members = held[topology.first[leaf] : topology.first[leaf] + topology.count[leaf]]
        assert 1 <= len(members) <= max_leaf_size and len(set(members.tolist())) == len(members)
        covered[members] |= ((topology.lower[leaf] <= points[members]) & (points[members] <= topology.upper[leaf])).all(axis=2)
        assert (topology.lower[leaf] >= triangles[members].min(axis=(0, 1))).all() and (topology.upper[leaf] <= triangles[members].max(axis=(0, 1))).all()
    # Sums of weighted vertices round, even in double precision, and may lie outside the triangle's own box.
    outside = ((points < triangles.min(axis=1)[:, None]) | (points > triangles.max(axis=1)[:, None])).any(axis=2)
    assert (covered | outside).all() and outside.mean() < 0.5


coordinates = st.one_of(st.integers(-4, 4).map(float), st.floats(-1.0, 1.0, width=32), st.floats(width=32, allow_nan=False, allow_infinity=False))
soups = st.lists(st.tuples(*[coordinates] * 9), min_size=1, max_size=60).map(lambda rows: np.array(rows, np.float32).reshape(-1, 3, 3))


@settings(max_examples=150, deadline=None)
@given(soups, st.sampled_from([1, 2, 4, 8]), st.sampled_from([1, 8]))
def test_any_triangles(triangles: np.ndarray, max_leaf_size: int, block: int) -> None:
    check(spatial.build(triangles, max_leaf_size, block=block), triangles, max_leaf_size)


def difficult() -> dict[str, np.ndarray]:
    """Kinds of triangles that are hard to part, each with some that cross the others."""
    random, crossing = np.random.default_rng(2), beams(40, 3)
    points = random.uniform(-1, 1, (150, 3, 3)).astype(np.float32)
    return {"beams": crossing, "the same": np.repeat(crossing[::3], 3, axis=0),
            "points and lines": np.concatenate([points[:, [0, 0, 0]], points[:, [0, 1, 1]]]),
            "huge and tiny": np.concatenate([crossing * np.float32(1e6), crossing, crossing * np.float32(1e-6)]),
            "far away": crossing + np.float32(1000.0), "in a plane": np.where(np.arange(3) == 1, np.float32(0.0), crossing),
            "largest there are": points * np.float32(3e38), "least there are": points * np.float32(1e-42)}


@pytest.mark.parametrize("kind", list(difficult()))
@pytest.mark.parametrize(("max_leaf_size", "block"), [(1, 1), (4, 1), (8, 8)])
def test_difficult_triangles(kind: str, max_leaf_size: int, block: int) -> None:
    triangles = difficult()[kind]
    check(spatial.build(triangles, max_leaf_size, block=block), triangles, max_leaf_size)


@pytest.mark.parametrize("kind", ["beams", "the same", "huge and tiny", "far away"])
def test_rays_meet_what_the_list_meets(device: Any, kind: str) -> None:
    """Slivers, duplicates, sizes that differ by 10¹²: with rays towards points on edges, which are where parts end."""
    triangles = difficult()[kind]
    random = np.random.default_rng(5)
    origins, directions = rays_around(triangles, 20_000, random)
    edge = random.dirichlet([1, 1], 10_000)
    chosen = triangles[random.integers(len(triangles), size=10_000)]
    directions[::2] = edge[:, :1] * chosen[:, 0] + edge[:, 1:] * chosen[:, 1] - origins[::2]
    expected = Tracer(device, triangles, Flat()).nearest(origins, directions)
    met = expected[1] != NONE
    assert met.mean() > 0.1
    for tree in TREES:
        if not isinstance(tree, SpatialSplits) or (tree.name == "bvh8" and is_gpu(device)):  # to the bit only where divisions round correctly
            continue
        topology = topology_of(tree, triangles)
        assert topology.references is not None, f"no reference is shared in {title(tree)}: the case tells nothing"
        tracer = Tracer(device, triangles, tree, topology=topology)
        hits, primitives = tracer.nearest(origins, directions)
        assert np.array_equal(hits[:, 0], expected[0][:, 0]) and np.array_equal(primitives == NONE, ~met)
        if kind != "the same":
            assert_same_hits((hits, primitives), expected)
        assert np.array_equal(tracer.occluded(origins, directions), met)


def test_rays_at_the_faces_of_parts_meet_what_the_plain_tree_meets(device: Any) -> None:
    """From within closed beams towards the points where their edges cross a face of a leaf's box."""
    triangles, random = beams(40, 3), np.random.default_rng(11)
    for tree in TREES:
        if not isinstance(tree, SpatialSplits):
            continue
        topology = topology_of(tree, triangles)
        leaves = np.flatnonzero(topology.leaves)
        leaves = leaves[np.argsort(topology.first[leaves])]
        leaf_of = np.repeat(leaves, topology.count[leaves])
        members = topology.order[topology.references]
        targets, beam = [], []
        for face in (topology.lower, topology.upper):
            for axis, vertex in itertools.product(range(3), range(3)):
                begin, end = triangles[members, vertex].astype(np.float64), triangles[members, vertex - 1].astype(np.float64)
                extent = end[:, axis] - begin[:, axis]
                part = np.divide(face[leaf_of, axis] - begin[:, axis], extent, out=np.zeros(len(members)), where=extent != 0.0)
                crosses = (part > 0.01) & (part < 0.99)
                targets.append((begin + part[:, None] * (end - begin))[crosses])
                beam.append((members // 12)[crosses])
        targets, beam = np.repeat(np.concatenate(targets), 8, axis=0), np.repeat(np.concatenate(beam), 8)
        assert len(targets) > 20_000
        corners = triangles.reshape(-1, 36, 3).astype(np.float64)
        middle, along = corners.mean(axis=1)[beam], (corners[:, 1] - corners[:, 0])[beam]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        onto = middle + along * (((targets - middle) * along).sum(axis=1, keepdims=True) + random.normal(size=(len(targets), 1)) * 0.01)
        origins = (onto + random.choice([0.0, 0.5, 0.9], (len(targets), 1)) * (targets - onto)).astype(np.float32)
        directions = (targets - origins).astype(np.float32)
        expected = Tracer(device, triangles, tree.layout).nearest(origins, directions)
        assert (expected[1] != NONE).mean() > 0.99
        assert_same_hits(Tracer(device, triangles, tree, topology=topology).nearest(origins, directions), expected)


def test_slices_hold_what_lies_between_the_planes() -> None:
    """Bounds against those of many points, which they contain and of which they are no more than the points' distance larger."""
    random = np.random.default_rng(6)
    triangles = random.uniform(-1, 1, (200, 3, 3))
    triangles[::4, 1, 0] = triangles[::4, 0, 0]  # an edge across the axis
    ascending = spatial.along_each_axis(triangles)[0]
    planes = np.sort(random.uniform(-1.2, 1.2, (200, 3)), axis=1)
    planes[::5, 1] = triangles[::5, 2, 0]  # through a vertex
    planes.sort(axis=1)
    lower, upper = slices(ascending, ascending[:, 0], planes.ravel(), np.full(200, 2))
    points = np.einsum("pv,nva->npa", random.dirichlet([0.5, 0.5, 0.5], 20_000), triangles)
    told = 0
    for i in range(400):
        x = points[i // 2, :, 0]
        inside = points[i // 2, (planes[i // 2, i % 2] <= x) & (x <= planes[i // 2, i % 2 + 1])]
        if len(inside) > 2000:
            told += 1
            assert (lower[:, i] <= inside.min(axis=0) + 1e-12).all() and (upper[:, i] >= inside.max(axis=0) - 1e-12).all()
            assert (inside.min(axis=0) - lower[:, i] < 0.1).all() and (upper[:, i] - inside.max(axis=0) < 0.1).all()
    assert told > 100


def test_beams_that_cross_cost_a_quarter_less() -> None:
    triangles = beams(200, 7)
    plain = build(triangles.min(axis=1), triangles.max(axis=1))
    assert sah_cost(spatial.build(triangles)) < 0.75 * sah_cost(plain)


def test_a_grid_is_not_cut() -> None:
    """Neighbours hardly overlap there: no split is spatial, and the tree is the plain one, without references."""
    x, y = np.meshgrid(np.arange(24.0), np.arange(24.0))
    corner = np.stack([x, y, 0.1 * np.sin(x)], axis=-1).reshape(-1, 1, 3)
    triangles = (corner + np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])).astype(np.float32)
    plain, ours = build(triangles.min(axis=1), triangles.max(axis=1)), spatial.build(triangles)
    assert ours.references is None and sah_cost(ours) == sah_cost(plain)


def test_only_layouts_that_hold_references_are_built_so() -> None:
    with pytest.raises(ValueError, match="found the layout cwbvh, whose leaves cannot share a triangle, expected one of bvh2, bvh8"):
        SpatialSplits(Cwbvh())
    for name, layout in layouts().items():
        chosen = with_spatial_splits(preferring(name))("triangle", 100, bounded=True, wide=True)
        assert chosen.name == name and isinstance(chosen, SpatialSplits) == layout.holds_references
        assert not isinstance(with_spatial_splits(preferring(name))("sphere", 100, bounded=True, wide=True), SpatialSplits)
    with pytest.raises(ValueError, match="found vertices that are not finite"):
        spatial.build(np.full((1, 3, 3), np.nan, np.float32))


def scene(*, dark: bool) -> Scene:
    """Beams under a lamp; unless it is ``dark``, some shine and some let rays through by chance, which draws random numbers by triangles' numbers."""
    def mesh(n: int, seed: int, **keys: Any) -> dict[str, Any]:
        return {"type": "mesh", "vertices": beams(n, seed).reshape(-1, 3).tolist(), "faces": np.arange(36 * n).reshape(-1, 3).tolist(), **keys}

    shining = {} if dark else {"emission": 2.0}
    return load({"scene": {
        "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
        "film": {"width": 32, "height": 32, "aovs": ["object_id", "normal", "depth"]}, "sampler": {"spp": 8}, "integrator": {"max_depth": 4},
        "materials": {"pale": {"type": "lambert", "opacity": 1.0 if dark else 0.5}},
        "geometry": [mesh(60, 8), mesh(10, 9, **shining), mesh(10, 10, material="pale", visible={"shadow": False})],
        "lights": [{"type": "area", "position": [0, 4, 0], "normal": [0, -1, 0], "radius": 1.0, "radiance": 30.0}]}})


class Renumbered(SpatialSplits):
    """The layout's plain tree, but its triangles numbered as they are with spatial splits."""

    def topology(self, shape: Any, records: np.ndarray) -> Topology:
        order = super().topology(shape, records).order
        plain = self.layout.topology(shape, records)
        return replace(plain, order=order, references=np.argsort(order).astype(np.uint32)[plain.order])


def picture(device: Any, made: Scene, choice: Choice) -> tuple[Image, bool]:
    """And whether leaves share triangles."""
    render = Render(made, device.name, overrides=Overrides(accelerator=choice))
    render.run()
    return render.image({}), render.wavefront.buffers.features.shared_primitives == ("triangle",)


@pytest.mark.parametrize("layout", [name for name, kind in layouts().items() if kind.holds_references])
def test_the_picture_is_the_same_to_the_bit(device: Any, layout: str) -> None:
    """As with the plain tree; where numbers draw random numbers, as with the plain tree over triangles of the same numbers."""
    plain = preferring(layout)
    for dark in (True, False):
        made = scene(dark=dark)
        expected, shares = picture(device, made, plain if dark else lambda shape, *how: Renumbered(plain(shape, *how)) if shape == "triangle"
                                   else plain(shape, *how))
        assert shares != dark
        ours, shares = picture(device, made, with_spatial_splits(plain))
        assert shares
        assert expected.pixels.max() > 0.5 and len(np.unique(expected.aovs["object_id"])) >= 4
        assert np.array_equal(ours.pixels, expected.pixels)
        for name, layer in expected.aovs.items():
            assert np.array_equal(ours.aovs[name], layer), name


def test_the_device_gets_what_it_would_without() -> None:
    assert with_spatial_splits(choose)("triangle", 8, bounded=True, wide=True).name == "flat"
    assert with_spatial_splits(choose)("triangle", 9, bounded=True, wide=True).name == "bvh8"
    assert with_spatial_splits(choose)("triangle", 9, bounded=True, wide=False).name == "bvh2"
