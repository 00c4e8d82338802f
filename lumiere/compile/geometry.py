"""Shapes → primitives in leaf order, their accelerators, and the objects that they belong to."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from lumiere.accel import Choice, choose
from lumiere.accel.spatial import SpatialSplits
from lumiere.bsdf import Material
from lumiere.shape import DeviceShape, Primitives, Shape
from lumiere.texture import Texture

NO_CORNER = 0xFFFFFFFF


@dataclass
class Object:
    """Primitives that share a material: a row of the device's object table."""

    shape: Shape
    primitives: Primitives
    material: Material
    emission: tuple[float, float, float] | Texture | None
    both_sides: bool


@dataclass
class ShapeGroup:
    """All primitives of one device shape, in leaf order, with its accelerator's buffers. ``objects`` (n,) uint32 says whose each is."""

    device_shape: type[DeviceShape]
    records: np.ndarray
    objects: np.ndarray
    layout: str
    accelerator: dict[str, np.ndarray]
    corners: np.ndarray | None = None


@dataclass
class Vertices:
    """What vertices carry, for all meshes that have any of it: (n, 3) normals (0: none), (n, 2) uvs (NaN: none), (n, 3) colours."""

    normals: list[np.ndarray] = field(default_factory=list)
    uvs: list[np.ndarray] = field(default_factory=list)
    colors: list[np.ndarray] = field(default_factory=list)
    count: int = 0

    def add(self, primitives: Primitives) -> np.ndarray:
        """Adds the vertices of ``primitives``; returns its triangles' corners, (m, 3) uint32."""
        if primitives.indices is None:
            return np.full((len(primitives.records), 3), NO_CORNER, dtype=np.uint32)
        carried = next(a for a in (primitives.normals, primitives.uvs, primitives.colors) if a is not None)
        size, first = len(carried), self.count
        self.count += size
        self.normals.append(np.zeros((size, 3)) if primitives.normals is None else primitives.normals)
        self.uvs.append(np.full((size, 2), np.nan) if primitives.uvs is None else primitives.uvs)
        self.colors.append(np.ones((size, 3)) if primitives.colors is None else primitives.colors)
        return (primitives.indices + first).astype(np.uint32)


def group_shapes(objects: list[Object], keep: tuple[str, ...], wide: bool,
                 choose_accelerator: Choice = choose) -> tuple[list[ShapeGroup], Vertices]:
    """One group for each device shape that ``objects`` hold, triangles first. ``keep`` names what vertices carry that the scene uses
    (``normals``, ``uvs``, ``colors``); ``wide``: the device has wide vectors.
    """
    vertices = Vertices()
    groups = []
    by_shape: dict[type[DeviceShape], list[int]] = {}
    for number, item in enumerate(objects):
        if len(item.primitives.records):
            by_shape.setdefault(item.primitives.device_shape, []).append(number)
    for device_shape in sorted(by_shape, key=lambda s: (not s.bounded, s.name != "triangle", s.name)):
        members = by_shape[device_shape]
        records = np.concatenate([objects[i].primitives.records for i in members])
        owners = np.concatenate([np.full(len(objects[i].primitives.records), i, dtype=np.uint32) for i in members])
        corners = None
        if device_shape.name == "triangle" and any(_carries(objects[i].primitives, keep) for i in members):
            corners = np.concatenate([vertices.add(_only(objects[i].primitives, keep)) for i in members])
        accelerator = choose_accelerator(device_shape.name, len(records), device_shape.bounded, wide)
        buffers: dict[str, np.ndarray] = {}
        if device_shape.bounded:
            cuts = isinstance(accelerator, SpatialSplits)
            topology = accelerator.build_triangles(records["vertices"]) if cuts else accelerator.build(*device_shape.bounds(records))
            order = topology.order
            records, owners = records.take(order), owners.take(order)
            corners = corners if corners is None else corners.take(order, axis=0)
            buffers = accelerator.encode(topology, records)
        groups.append(ShapeGroup(device_shape, records, owners, accelerator.name, buffers, corners))
    return groups, vertices


def _carries(primitives: Primitives, keep: tuple[str, ...]) -> bool:
    return any(getattr(primitives, name) is not None for name in keep)


def _only(primitives: Primitives, keep: tuple[str, ...]) -> Primitives:
    """``primitives`` with only what the scene uses of what its vertices carry."""
    carried = {name: getattr(primitives, name) if name in keep else None for name in ("normals", "uvs", "colors")}
    indices = primitives.indices if any(value is not None for value in carried.values()) else None
    return Primitives(primitives.device_shape, primitives.records, indices=indices, **carried)
