"""The area light."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf.lambert import Lambert
from lumiere.light import LIGHTS, Light
from lumiere.scene.fields import Spectrum, choice, number, spectrum, transform, vector
from lumiere.shape import Shape
from lumiere.shape.disk import Disk
from lumiere.shape.rectangle import Rectangle
from lumiere.shape.sphere import Sphere


@LIGHTS.register
@dataclass(kw_only=True)
class AreaLight(Light):
    """A rectangle, disk or sphere that emits, black otherwise; a shape with ``emission`` does the same.

    With ``radius`` and ``normal`` it is a disk, with ``radius`` alone a sphere, else a rectangle; ``shape`` says it outright.
    """

    type: ClassVar[str] = "area"

    shape: str | None = choice(None, ["rectangle", "disk", "sphere"], nullable=True, doc="told by the other keys unless given")
    position: tuple[float, float, float] | None = vector(None, nullable=True, doc="centre of a disk or sphere")
    normal: tuple[float, float, float] | None = vector(None, nullable=True, doc="of a disk")
    radius: float | None = number(None, low=0.0, low_open=True, nullable=True, doc="of a disk or sphere")
    transform: Any = transform(doc="as a shape's")
    radiance: Spectrum | None = spectrum(None, nullable=True, doc="W m⁻² sr⁻¹ (default 1)")
    power: Spectrum | None = spectrum(None, nullable=True, doc="W over the whole light, in place of radiance")
    sides: str = choice("front", ["front", "both"], doc="the side that the normal points to, or both")

    def check(self) -> str | None:
        """What is wrong with the keys together, or None."""
        kind = self._kind()
        if self.radiance is not None and self.power is not None:
            return "found both radiance and power, expected one of the two"
        allowed = {"rectangle": ("transform",), "disk": ("transform", "position", "normal", "radius"), "sphere": ("transform", "position", "radius")}
        for key in ("position", "normal", "radius"):
            if getattr(self, key) is not None and key not in allowed[kind]:
                return f"found {key} on a {kind}, expected {', '.join(allowed[kind])}"
        return None

    def _kind(self) -> str:
        if self.shape is not None:
            return self.shape
        if self.normal is not None:
            return "disk"
        return "sphere" if self.radius is not None or self.position is not None else "rectangle"

    def lower(self) -> Shape:
        kind = {"rectangle": Rectangle, "disk": Disk, "sphere": Sphere}[self._kind()]
        keys = {key: getattr(self, key) for key in ("position", "normal", "radius", "transform") if getattr(self, key) is not None}
        shape = kind(name=self.name, material=Lambert(albedo=(0.0, 0.0, 0.0)), emission_sides=self.sides, **keys)
        shape.emission = self._radiance(shape)
        return shape

    def _radiance(self, shape: Shape) -> Spectrum:
        if self.power is None:
            return self.radiance or (1.0, 1.0, 1.0)
        area = sum(float(primitives.device_shape.areas(primitives.records).sum()) for primitives in shape.lower())
        sides = 2.0 if self.sides == "both" else 1.0
        red, green, blue = (channel / (math.pi * sides * area) for channel in self.power)
        return red, green, blue
