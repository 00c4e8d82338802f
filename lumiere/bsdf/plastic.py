"""Plastic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material, is_smooth
from lumiere.scene.fields import Spectrum, number, spectrum


@MATERIALS.register
@dataclass(kw_only=True)
class Plastic(Material):
    """A clear coat over a Lambert base: plastics, varnish, glazed ceramics, billiard balls.

    The coat is a GGX dielectric (Walter et al. 2007), α = roughness². The base gets what the coat does not reflect and gives it back the
    same way, with the light that the coat reflects back down inside, so that colours deepen; at albedo 1 every direction reflects
    everything, to 0.005: the coat's reflectance comes from a table. After Ashikhmin, Premože & Shirley 2000 and Jakob's roughplastic of Mitsuba.
    Without the scene's ``energy_compensation`` the light that meets the coat's facets more than once is lost, on its way in, inside and out.
    """

    type: ClassVar[str] = "plastic"
    device_parameters: ClassVar[dict[str, str]] = {"albedo": "spectrum", "ior": "number", "roughness": "number"}

    energy_tolerance: ClassVar[float] = 0.005

    albedo: Spectrum | Any = spectrum(0.5, high=1.0, textured=True, doc="fraction that the base reflects of light inside the coat")
    ior: float | Any = number(1.5, low=1.0, high=2.5, textured=True, doc="index of refraction of the coat")
    roughness: float | Any = number(0.2, low=0.0, high=1.0, textured=True, doc="of the coat: 0 (clear) to 1")

    @property
    def compensates(self) -> bool:  # type: ignore[override]
        return not is_smooth(self.roughness)

    @classmethod
    def examples(cls) -> list[Material]:
        return [
            cls(albedo=(0.8, 0.4, 0.1)),
            cls(albedo=(1.0, 1.0, 1.0), roughness=0.5),
            cls(albedo=(1.0, 1.0, 1.0), roughness=0.0),
            cls(albedo=(1.0, 1.0, 1.0), roughness=0.05, ior=1.8),
            cls(albedo=(0.0, 0.0, 0.0), roughness=1.0, ior=1.3),
        ]
