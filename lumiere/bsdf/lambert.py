"""Lambert."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material
from lumiere.scene.fields import Spectrum, spectrum


@MATERIALS.register
@dataclass(kw_only=True)
class Lambert(Material):
    """Ideal diffuse reflection: the same radiance in every direction (Lambert 1760). Unpainted plaster, matt paper."""

    type: ClassVar[str] = "lambert"
    device_parameters: ClassVar[dict[str, str]] = {"albedo": "spectrum"}

    albedo: Spectrum | Any = spectrum(0.8, high=1.0, textured=True, doc="reflected fraction")

    @classmethod
    def examples(cls) -> list[Material]:
        return [cls(albedo=(1.0, 1.0, 1.0)), cls(albedo=(0.8, 0.4, 0.1))]
