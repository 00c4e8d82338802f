"""Accelerators: how a ray finds the primitives of one shape kind. ``NAME.py`` here and ``cl/accel/NAME.cl`` make one."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from lumiere.accel.build import Topology
from lumiere.device.array import Array
from lumiere.errors import UsageError

if TYPE_CHECKING:
    from lumiere.shape import DeviceShape

FLAT_UP_TO = 8
"""As many primitives are faster tested one after the other than through a tree of two or three nodes."""


PACKETS_UP_TO = 128
"""As many triangles are faster tested one after the other by sixteen rays at once than through a tree by one ray (docs/performance.md)."""


PACKET_LAYOUTS = ("flat16",)
"""Layouts that sixteen rays traverse at once (cl/accel/packet.cl)."""


SPATIAL = "_spatial"
"""Ends the name of an accelerator that builds its layout's trees with spatial splits (lumiere/accel/spatial.py)."""


@dataclass
class Accelerated:
    """Primitives of a device shape behind an accelerator.

    ``order``: (n,) uint32, the primitives in leaf order; ``records`` and ``corners`` (n, 3), where there are any, are theirs in that order; ``arrays``: what
    ``encode`` makes; ``low``, ``high``: (3,) float32 bounds of them all.
    """

    order: np.ndarray
    records: Array
    corners: Array | None
    arrays: dict[str, Array]
    low: np.ndarray
    high: np.ndarray


class Accelerator:
    """A builder and a layout. ``cl/accel/{name}.cl`` traverses what ``encode`` makes."""

    name: ClassVar[str]
    triangles_only: ClassVar[bool] = False
    holds_references: ClassVar[bool] = False
    """Leaves may share a primitive: ``encode`` takes a topology's ``references`` and keeps them as an array, which the traversal reads
    where SHAPE_PRIMITIVE does (cl/accel/template.cl)."""

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology:
        """The topology over boxes (n, 3) float32; ``order`` is the order in which the primitives have to be stored."""
        raise NotImplementedError

    def encode(self, topology: Topology, records: np.ndarray) -> dict[str, np.ndarray]:
        """The device's arrays, of float32 or uint32, by name: the field ``{shape}_{name}`` of ``scene_t``. ``records`` are in leaf order."""
        raise NotImplementedError

    def topology(self, shape: type[DeviceShape], records: np.ndarray) -> Topology:
        """The topology over primitives of ``shape``: what ``build`` makes of their boxes."""
        return self.build(*shape.bounds(records))

    def accelerate(self, shape: type[DeviceShape], records: np.ndarray, corners: np.ndarray | None = None) -> Accelerated:
        """At least one of the primitives of ``shape``, in leaf order, and the arrays: ``topology`` and ``encode`` on the host."""
        topology = self.topology(shape, records)
        order = topology.order
        records = records.take(order)
        corners = None if corners is None else corners.take(order, axis=0)
        return Accelerated(order, records, corners, {**self.encode(topology, records)}, topology.lower[0], topology.upper[0])


def choose(shape: str, n_primitives: int, bounded: bool, wide: bool) -> Accelerator:
    """The accelerator for ``n_primitives`` of a device shape, whose boxes are finite or not, on a device that has wide vectors or not."""
    from lumiere.accel.bvh2 import Bvh2
    from lumiere.accel.bvh8 import Bvh8
    from lumiere.accel.flat import Flat

    if not bounded or n_primitives <= FLAT_UP_TO:
        return Flat()
    return Bvh8() if wide and shape == "triangle" else Bvh2()


Choice = Callable[[str, int, bool, bool], Accelerator]
"""Chooses as ``choose`` does."""


def with_packets(choice: Choice) -> Choice:
    """``choice``, but ``flat16`` where sixteen rays are traced together faster. Not for rays that have to be told apart."""
    def chosen(shape: str, n_primitives: int, bounded: bool, wide: bool) -> Accelerator:
        from lumiere.accel.flat16 import Flat16

        return Flat16() if wide and shape == "triangle" and n_primitives <= PACKETS_UP_TO else choice(shape, n_primitives, bounded, wide)

    return chosen


def layouts() -> dict[str, type[Accelerator]]:
    """Every layout that one ray traverses at a time, by name: a module of this package of whose classes one has the module's name."""
    found = {}
    for module in pkgutil.iter_modules(__path__):
        for thing in vars(importlib.import_module(f"{__name__}.{module.name}")).values():
            if isinstance(thing, type) and getattr(thing, "name", None) == module.name and module.name not in PACKET_LAYOUTS:
                found[module.name] = thing
    return found


def names() -> list[str]:
    """What ``preferring`` takes: every layout, and with spatial splits those whose leaves can share triangles."""
    return sorted([*layouts(), *(f"{name}{SPATIAL}" for name, layout in layouts().items() if layout.holds_references)])


def preferring(name: str) -> Choice:
    """Chooses the accelerator called ``name`` for all that it can hold, on any device. Raises UsageError where there is none."""
    from lumiere.accel.spatial import with_spatial_splits

    if name not in names():
        raise UsageError(f"found the accelerator '{name}', expected one of {', '.join(names())}")
    layout = layouts()[name.removesuffix(SPATIAL)]

    def chosen(shape: str, n_primitives: int, bounded: bool, wide: bool) -> Accelerator:
        holds = bounded and (shape == "triangle" or not layout.triangles_only)
        return layout() if holds else choose(shape, n_primitives, bounded, wide)

    return with_spatial_splits(chosen) if name.endswith(SPATIAL) else chosen
