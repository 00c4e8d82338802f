"""Dielectric: glass, water, diamond."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material, is_smooth
from lumiere.scene.fields import Spectrum, number, spectrum, string


@MATERIALS.register
@dataclass(kw_only=True)
class Dielectric(Material):
    """The surface of a transparent body: reflects and refracts. Its normal points out of the body.

    Fresnel's equations for unpolarised light; where rough, GGX microfacets after Walter et al. 2007 with height-correlated Smith shadowing,
    which lose the light that would scatter more than once, or with the scene's ``energy_compensation`` give it back, to 0.012 (Kulla & Conty
    2017). α = roughness². ``ior`` is relative to what is around the body; 1 is
    invisible, below 1 is a bubble. Radiance carried into the body is scaled by ior² (Veach 1997, §5.2).
    """

    type: ClassVar[str] = "dielectric"
    reflective: ClassVar[bool] = False
    refracts: ClassVar[bool] = True

    ior: float | Any = number(1.5, low=0.0, low_open=True, textured=True,
                               doc="index of refraction, inside over outside; bounded to 0.001 … 1000")
    roughness: float | Any = number(0.0, low=0.0, high=1.0, textured=True, doc="0 (clear) to 1 (frosted)")
    transmittance: Spectrum | Any = spectrum(1.0, high=1.0, textured=True, doc="tint of the light that passes, at each crossing")
    transmittance_distance: float | None = number(None, low=0.0, low_open=True, nullable=True, doc="metres inside after which light has the tint "
                                                  "instead, by Beer's law (default: tinted at each crossing)")
    interior: str | None = string(None, nullable=True, doc="name of the medium inside")

    @property
    def purely_specular(self) -> bool:  # type: ignore[override]
        return is_smooth(self.roughness)

    @property
    def device_kind(self) -> str:
        return "dielectric" if self.purely_specular else "rough_dielectric"

    @property
    def device_parameters(self) -> dict[str, str]:  # type: ignore[override]
        smooth = {"ior": "number", "transmittance": "spectrum", "transmittance_distance": "number"}
        return smooth if self.purely_specular else smooth | {"roughness": "number"}

    @property
    def device_features(self) -> tuple[str, ...]:  # type: ignore[override]
        return () if self.transmittance_distance is None else ("ABSORPTION",)

    def device_values(self) -> dict[str, Any]:
        return super().device_values() | {"transmittance_distance": self.transmittance_distance or 0.0}

    @property
    def compensates(self) -> bool:  # type: ignore[override]
        return not self.purely_specular

    @classmethod
    def examples(cls) -> list[Material]:
        return [
            cls(),
            cls(ior=2.42, transmittance=(0.9, 0.5, 0.1)),
            cls(ior=0.7),
            cls(ior=1.0),
            cls(roughness=0.03),
            cls(roughness=0.4, transmittance=(0.9, 0.5, 0.1)),
            cls(ior=1.1, roughness=0.7),
            cls(ior=0.7, roughness=0.5),
            cls(ior=2.42, roughness=1.0),
        ]
