"""Principled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material
from lumiere.scene.fields import Spectrum, number, spectrum


def _used(value: Any) -> bool:
    """Is a weight, which a texture may stand for, more than 0 anywhere?"""
    return any(value) if isinstance(value, tuple) else value != 0.0


@MATERIALS.register
@dataclass(kw_only=True)
class Principled(Material):
    """Metal, glass, or a glossy dielectric over a diffuse base, mixed, under a clear coat, under sheen: one material for most things.

    The parameters are those of Burley 2012 and 2015 as Blender and OpenPBR 1.1 (Andersson et al. 2024) have them. Layers pass on what they do
    not reflect; ``energy_compensation`` gives back what rough facets lose, so that a white one reflects what it receives. A lobe that no
    material of the scene has costs nothing.
    """

    type: ClassVar[str] = "principled"
    energy_tolerance: ClassVar[float] = 0.005

    base_color: Spectrum | Any = spectrum(0.8, high=1.0, textured=True,
                                          doc="of the base, of metal head on, and of light that has crossed the body's surface twice")
    metallic: float | Any = number(0.0, low=0.0, high=1.0, textured=True, doc="0 (dielectric) to 1 (metal)")
    roughness: float | Any = number(0.5, low=0.0, high=1.0, textured=True, doc="0 (polished) to 1; bounded to 0.01 from below")
    specular: float | Any = number(0.5, low=0.0, high=1.0, textured=True,
                                   doc="scales the dielectric's gloss: 0 none, 0.5 as ior says, 1 twice as much head on")
    ior: float | Any = number(1.5, low=1.0, high=1e3, textured=True, doc="index of refraction of the dielectric")
    specular_tint: Spectrum | Any = spectrum(1.0, high=1.0, textured=True, doc="colours the dielectric's gloss head on")
    anisotropy: float | Any = number(0.0, low=0.0, high=1.0, textured=True, doc="0 (isotropic) to 1 (highlights ten times as long along u)")
    sheen: Spectrum | Any = spectrum(0.0, high=1.0, textured=True, doc="weight and colour of the fuzz of cloth")
    sheen_roughness: float | Any = number(0.3, low=0.0, high=1.0, textured=True, doc="0 (only at the rim) to 1; bounded to 0.1 from below")
    clearcoat: float | Any = number(0.0, low=0.0, high=1.0, textured=True, doc="weight of a clear coat of index 1.5")
    clearcoat_roughness: float | Any = number(0.03, low=0.0, high=1.0, textured=True, doc="of the clear coat")
    transmission: float | Any = number(0.0, low=0.0, high=1.0, textured=True, doc="fraction of what is not metal that is glass")
    subsurface: float | Any = number(0.0, low=0.0, high=1.0, textured=True, doc="fraction of the base that scatters below the surface")
    subsurface_radius: Spectrum | Any = spectrum((1.0, 0.2, 0.1), textured=True, doc="mean free path there, metres")

    @property
    def device_parameters(self) -> dict[str, str]:  # type: ignore[override]
        usual = {"base_color": "spectrum", "metallic": "number", "roughness": "number", "specular": "number", "ior": "number",
                 "specular_tint": "spectrum", "anisotropy": "number", "sheen": "spectrum", "sheen_roughness": "number", "clearcoat": "number",
                 "clearcoat_roughness": "number", "transmission": "number"}
        return usual | {"subsurface": "number", "subsurface_radius": "spectrum"} if _used(self.subsurface) else usual

    @property
    def refracts(self) -> bool:  # type: ignore[override]
        return _used(self.transmission)

    @property
    def reflective(self) -> bool:  # type: ignore[override]
        return not (self.refracts or _used(self.subsurface))

    @property
    def device_features(self) -> tuple[str, ...]:  # type: ignore[override]
        lobes = {"PRINCIPLED_COAT": self.clearcoat, "PRINCIPLED_SHEEN": self.sheen, "PRINCIPLED_GLASS": self.transmission,
                 "WALKS": self.subsurface}
        return ("ENERGY_COMPENSATION", *(name for name, weight in lobes.items() if _used(weight)))

    @classmethod
    def examples(cls) -> list[Material]:
        white = (1.0, 1.0, 1.0)
        return [
            cls(base_color=white),
            cls(base_color=(0.8, 0.4, 0.1), roughness=0.05, specular=1.0, specular_tint=(1.0, 0.5, 0.2)),
            cls(base_color=white, metallic=1.0, roughness=1.0),
            cls(base_color=(0.9, 0.6, 0.2), metallic=0.5, roughness=0.3, anisotropy=0.8),
            cls(base_color=white, transmission=1.0, roughness=0.4),
            cls(base_color=(0.9, 0.5, 0.3), transmission=0.5, metallic=0.2, roughness=0.2, ior=1.8, clearcoat=0.7),
            cls(base_color=(0.5, 0.1, 0.1), roughness=0.6, sheen=(0.8, 0.8, 1.0), clearcoat=1.0, clearcoat_roughness=0.2),
            cls(base_color=white, sheen=white, sheen_roughness=0.2, specular=0.0),
            cls(base_color=(0.9, 0.5, 0.3), subsurface=1.0, roughness=0.3),
            cls(base_color=white, subsurface=0.4, metallic=0.3, clearcoat=0.5, sheen=(0.5, 0.3, 0.2)),
            cls(base_color=white, roughness=0.3, clearcoat=1.0, clearcoat_roughness=0.0),
        ]
