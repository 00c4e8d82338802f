"""Conductor: metals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material, is_smooth
from lumiere.bsdf.metals import METALS
from lumiere.scene.fields import Spectrum, choice, number, spectrum


@MATERIALS.register
@dataclass(kw_only=True)
class Conductor(Material):
    """Metal, by its complex index of refraction ``eta`` + i ``k`` relative to what is around it: named, or given.

    Fresnel's equations for conductors (Born & Wolf 1999, §14.2); where rough, GGX microfacets with height-correlated Smith shadowing
    (Walter et al. 2007; Heitz 2014), which give back the light that meets them more than once, to 0.005 (Kulla & Conty 2017), or without the
    scene's ``energy_compensation`` lose it. α = roughness², stretched along the u direction of the surface's uv by ``anisotropy`` as Burley 2012
    does: αx / αy = 1 / (1 − 0.9 anisotropy).
    """

    type: ClassVar[str] = "conductor"

    metal: str | None = choice(None, list(METALS), nullable=True,
                               doc='name of a measured metal; "none", the default where eta and k are not given either, reflects everything')
    eta: Spectrum | Any = spectrum(None, high=1e4, textured=True, nullable=True, doc="real part of the index")
    k: Spectrum | Any = spectrum(None, high=1e4, textured=True, nullable=True, doc="imaginary part of the index (extinction)")
    roughness: float | Any = number(0.0, low=0.0, high=1.0, textured=True, doc="0 (a mirror) to 1")
    anisotropy: float | Any = number(0.0, low=0.0, high=1.0, textured=True, doc="0 (isotropic) to 1 (highlights ten times as long along u)")

    def check(self) -> str | None:
        if self.metal is not None and (self.eta is not None or self.k is not None):
            return "found 'metal' together with 'eta' or 'k', expected one or the other: remove 'metal', or 'eta' and 'k'"
        if (self.eta is None) != (self.k is None):
            given, missing = ("eta", "k") if self.k is None else ("k", "eta")
            return f"found '{given}' without '{missing}', expected both: add '{missing}', or name a 'metal' instead"
        return None

    @property
    def purely_specular(self) -> bool:  # type: ignore[override]
        return is_smooth(self.roughness)

    @property
    def device_kind(self) -> str:
        return "conductor" if self.purely_specular else "rough_conductor"

    @property
    def device_parameters(self) -> dict[str, str]:  # type: ignore[override]
        index = {"eta": "spectrum", "k": "spectrum"}
        return index if self.purely_specular else index | {"roughness": "number", "anisotropy": "number"}

    @property
    def compensates(self) -> bool:  # type: ignore[override]
        return not self.purely_specular

    @property
    def energy_tolerance(self) -> float:  # type: ignore[override]
        return 0.005 if self.compensates else 0.0

    def device_values(self) -> dict[str, Any]:
        eta, k = METALS[self.metal or "none"] if self.eta is None else (self.eta, self.k)
        values = {"eta": eta, "k": k, "roughness": self.roughness, "anisotropy": self.anisotropy}
        return {name: values[name] for name in self.device_parameters}

    @classmethod
    def examples(cls) -> list[Material]:
        return [
            cls(),
            cls(metal="gold"),
            cls(metal="copper", roughness=0.03),
            cls(metal="aluminium", roughness=0.3, anisotropy=0.8),
            cls(metal="gold", roughness=0.7),
            cls(roughness=1.0),
        ]
