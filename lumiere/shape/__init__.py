"""Shapes: one file a kind of the format, and one a device shape (``cl/shape/NAME.cl``) that kinds are lowered to.

A rectangle and a box are triangles on the device; a sphere, a disk and a plane are themselves.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lumiere.registry import Registry
from lumiere.scene.fields import boolean, choice, material, nested, spectrum, string, transform

if TYPE_CHECKING:
    from lumiere.bsdf import Material
    from lumiere.texture import Texture


@dataclass(kw_only=True)
class Visibility:
    """Which rays see a shape."""

    camera: bool = boolean(True, doc="rays that leave the camera")
    shadow: bool = boolean(True, doc="shadow rays")


@dataclass
class Primitives:
    """Primitives of one device shape that share one material: what a shape of the format is lowered to.

    ``records`` is a structured array of the device shape's ``record`` dtype, in world space. ``corners`` holds, for triangles only, what its
    vertices carry: ``indices`` (n, 3) int into ``normals`` (m, 3), ``uvs`` (m, 2) and ``colors`` (m, 3), each None where the shape has none.
    """

    device_shape: type[DeviceShape]
    records: np.ndarray
    material: Material | None = None
    indices: np.ndarray | None = None
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None
    colors: np.ndarray | None = None
    dropped: dict[str, int] = field(default_factory=dict)


class DeviceShape:
    """What the device traces: ``name`` = ``cl/shape/NAME.cl``; ``record``, its numpy dtype; whether it is bounded and can be sampled as a light."""

    name: ClassVar[str]
    record: ClassVar[np.dtype]
    bounded: ClassVar[bool] = True

    @staticmethod
    def bounds(records: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corners, each (n, 3) float32, rounded outwards."""
        raise NotImplementedError

    @staticmethod
    def areas(records: np.ndarray) -> np.ndarray:
        """(n,) float64, square metres; 0 for what is not sampled as a light."""
        raise NotImplementedError


@dataclass(kw_only=True)
class Shape:
    """What every shape may carry. A subclass declares its keys and is lowered to device primitives by ``lower``."""

    type: ClassVar[str]

    name: str = string("", doc="for messages and object ids")
    transform: Any = transform(doc="object to world")
    material: Material | None = material(doc="a material's name or an inline material (default: Lambert 0.8)")
    emission: tuple[float, float, float] | Texture | None = spectrum(None, textured=True, nullable=True, doc="in place of the material's")
    emission_sides: str | None = choice(None, ["front", "both"], nullable=True, doc="in place of the material's")
    visible: Visibility = nested(Visibility, doc="which rays see it")

    def matrix(self) -> np.ndarray:
        """Object to world, (4, 4) float64."""
        return np.eye(4) if self.transform is None else np.asarray(self.transform, dtype=np.float64)

    def lower(self) -> list[Primitives]:
        """The shape's device primitives in world space."""
        raise NotImplementedError


def outwards(lower: np.ndarray, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """float64 corners as float32 ones that contain them."""
    lower32, upper32 = lower.astype(np.float32), upper.astype(np.float32)
    lower32 = np.where(lower32 > lower, np.nextafter(lower32, np.float32(-np.inf)), lower32)
    upper32 = np.where(upper32 < upper, np.nextafter(upper32, np.float32(np.inf)), upper32)
    return lower32, upper32


SHAPES: Registry[Shape] = Registry("lumiere.shape", "geometry")
