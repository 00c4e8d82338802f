"""Dielectric: glass, water, diamond."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from lumiere.bsdf import MATERIALS, Body, Material, is_smooth
from lumiere.scene.fields import Spectrum, integer, number, spectrum, string
from lumiere.texture import Texture

LINE_C, LINE_D, LINE_F = 0.65627, 0.58756, 0.48613
"""Wavelengths of Fraunhofer's lines, µm."""


def cauchy_dispersion(abbe_number: float | None) -> float:
    """D of ``cl/lib/dispersion.cl``, µm²: (n(λ) − 1) / (n(d) − 1) = 1 + D (1/λ² − 1/λd²). 0 without an Abbe number (n(d) − 1) / (n(F) − n(C))."""
    return 0.0 if abbe_number is None else 1.0 / (abbe_number * (LINE_F**-2 - LINE_C**-2))


@MATERIALS.register
@dataclass(kw_only=True)
class Dielectric(Material):
    """The surface of a transparent body: reflects and refracts. Its normal points out of the body.

    Fresnel's equations for unpolarised light; where rough, GGX microfacets after Walter et al. 2007 with height-correlated Smith shadowing,
    which give back the light that meets them more than once, to 0.005 (Kulla & Conty 2017), or without the scene's ``energy_compensation`` lose
    it. α = roughness². ``ior`` is relative to what is around the body; 1 is invisible, below 1 is a bubble. Radiance carried into the body is
    scaled by ior² (Veach 1997, §5.2).

    With an ``abbe_number`` the index depends on the wavelength, by Cauchy's formula through ``ior`` at 587.6 nm: each of the three channels sees the
    wavelengths about its primary's, so that a prism's rainbow is one of three colours that overlap. It costs glass nothing that has none.

    With a ``priority`` bodies may overlap, as water that reaches a little into its glass (Schmidt & Budge 2002): where they do, the one with the
    highest priority is there, and of equal ones the one entered last. A path remembers four bodies at once, and begins outside of all.
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
    abbe_number: float | None = number(None, low=1.0, nullable=True, doc="how little the index depends on the wavelength: 20 (flint glass) to 95; "
                                                                         "diamond 55 (default: not at all)")
    priority: int = integer(0, low=0, high=1e6, doc="of bodies that overlap the one with the highest priority is there, and ior is against vacuum "
                                                   "(default: 0, ior is against what is around)")
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
        smooth |= {} if self.abbe_number is None else {"dispersion": "number"}
        return smooth if self.purely_specular else smooth | {"roughness": "number"}

    @property
    def device_features(self) -> tuple[str, ...]:  # type: ignore[override]
        if self.priority:
            return ("PRIORITY",)
        has = {"ABSORPTION": self.transmittance_distance, "DISPERSION": self.abbe_number}
        return tuple(name for name, value in has.items() if value is not None)

    @property
    def body(self) -> Body | None:
        if not self.priority:
            return None
        distance = np.inf if self.transmittance_distance is None else self.transmittance_distance
        red, green, blue = -np.log(np.maximum(self.transmittance, 1e-30)) / distance
        return Body(self.priority, self.ior, (red, green, blue))

    def check(self) -> str | None:
        for name in ("ior", "transmittance"):
            if self.priority and isinstance(getattr(self, name), Texture):
                return f"found a texture for '{name}' together with 'priority', expected one value for the whole body: give a value"
        if self.priority and self.abbe_number is not None:
            return "found 'abbe_number' together with 'priority', which is not supported yet: remove one of them"
        if self.priority and self.transmittance_distance is None and min(self.transmittance) < 1.0:
            return "found 'transmittance' and 'priority' without 'transmittance_distance', expected the way over which a body tints: add it"
        return None

    def device_values(self) -> dict[str, Any]:
        values = {"ior": self.ior, "roughness": self.roughness, "transmittance": self.transmittance,
                  "transmittance_distance": self.transmittance_distance or 0.0, "dispersion": cauchy_dispersion(self.abbe_number)}
        return {name: values[name] for name in self.device_parameters}

    @property
    def compensates(self) -> bool:  # type: ignore[override]
        return not self.purely_specular

    @property
    def energy_tolerance(self) -> float:  # type: ignore[override]
        return 0.005 if self.compensates else 0.0

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
            cls(ior=1.7, abbe_number=20.0),
            cls(ior=1.7, abbe_number=5.0, roughness=0.3),
        ]
