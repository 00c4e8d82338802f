"""Oren–Nayar."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material
from lumiere.scene.fields import Spectrum, number, spectrum


@MATERIALS.register
@dataclass(kw_only=True)
class OrenNayar(Material):
    """Rough diffuse reflection, flatter than Lambert's and brighter back towards the light: clay, concrete, cloth, the Moon.

    The energy-preserving form, EON (Portsmouth, Kutz & Hill 2025, JCGT 14(1)): at albedo 1 every direction reflects everything, whatever
    the roughness. ``roughness`` is the paper's r: 0 is Lambert, 1 the roughest that the model holds for.
    """

    type: ClassVar[str] = "oren_nayar"
    device_parameters: ClassVar[dict[str, str]] = {"albedo": "spectrum", "roughness": "number"}

    albedo: Spectrum | Any = spectrum(0.8, high=1.0, textured=True, doc="reflected fraction of light that scatters once")
    roughness: float | Any = number(0.5, low=0.0, high=1.0, textured=True, doc="0 (Lambert) to 1")

    @classmethod
    def examples(cls) -> list[Material]:
        return [cls(albedo=(1.0, 1.0, 1.0), roughness=r) for r in (0.0, 0.5, 1.0)] + [cls(albedo=(0.8, 0.4, 0.1), roughness=0.8)]
