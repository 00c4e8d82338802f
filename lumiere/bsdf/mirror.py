"""Mirror."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material
from lumiere.scene.fields import Spectrum, spectrum


@MATERIALS.register
@dataclass(kw_only=True)
class Mirror(Material):
    """The ideal mirror, of the same reflectance at every angle. For a metal's, see ``conductor``."""

    type: ClassVar[str] = "mirror"
    device_parameters: ClassVar[dict[str, str]] = {"reflectance": "spectrum"}
    purely_specular: ClassVar[bool] = True

    reflectance: Spectrum | Any = spectrum(1.0, high=1.0, textured=True, doc="reflected fraction")

    @classmethod
    def examples(cls) -> list[Material]:
        return [cls(), cls(reflectance=(0.9, 0.5, 0.1))]
