"""Thin dielectric: panes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material
from lumiere.scene.fields import Spectrum, number, spectrum


@MATERIALS.register
@dataclass(kw_only=True)
class ThinDielectric(Material):
    """A thin pane modelled as one surface: a window, a soap film without its colours. What passes goes straight on.

    Both of its interfaces, and all reflections between them, in closed form (Stokes 1860; PBR 4ed, §9.5.1).
    """

    type: ClassVar[str] = "thin_dielectric"
    reflective: ClassVar[bool] = False
    purely_specular: ClassVar[bool] = True
    device_parameters: ClassVar[dict[str, str]] = {"ior": "number", "transmittance": "spectrum"}

    ior: float | Any = number(1.5, low=0.0, low_open=True, textured=True,
                               doc="index of refraction of the pane, over its surroundings; bounded to 0.001 … 1000")
    transmittance: Spectrum | Any = spectrum(1.0, high=1.0, textured=True, doc="tint of the light that passes")

    @classmethod
    def examples(cls) -> list[Material]:
        return [cls(), cls(ior=1.8, transmittance=(0.9, 0.5, 0.1)), cls(ior=1.0)]
