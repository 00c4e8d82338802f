"""Phong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material
from lumiere.scene.fields import Spectrum, number, spectrum


@MATERIALS.register
@dataclass(kw_only=True)
class Phong(Material):
    """A glossy lobe about the mirror direction, over a Lambert base (Lafortune & Willems 1994): simple, not physical.

    Reflects at most ``albedo`` + ``specular``, and exactly that at normal incidence; where their sum exceeds 1, both are scaled down to it.
    """

    type: ClassVar[str] = "phong"
    device_parameters: ClassVar[dict[str, str]] = {"albedo": "spectrum", "specular": "spectrum", "exponent": "number"}

    albedo: Spectrum | Any = spectrum(0.5, high=1.0, textured=True, doc="fraction reflected by the base")
    specular: Spectrum | Any = spectrum(0.25, high=1.0, textured=True, doc="fraction reflected by the lobe, at normal incidence")
    exponent: float | Any = number(32.0, low=0.0, high=1e8, textured=True,
                                    doc="power of the cosine about the mirror direction; higher is sharper")

    @classmethod
    def examples(cls) -> list[Material]:
        return [
            cls(albedo=(0.5, 0.3, 0.1), specular=(0.2, 0.3, 0.4), exponent=20.0),
            cls(albedo=(0.0, 0.0, 0.0), specular=(1.0, 1.0, 1.0), exponent=1e6),
            cls(albedo=(0.9, 0.9, 0.9), specular=(0.9, 0.9, 0.9), exponent=0.0),
        ]
