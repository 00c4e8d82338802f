"""Subsurface: skin, wax, marble, milk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material, is_smooth
from lumiere.scene.fields import Spectrum, number, spectrum


@MATERIALS.register
@dataclass(kw_only=True)
class Subsurface(Material):
    """A body that light goes into and comes out of elsewhere: a random walk (Chiang, Kutz & Burley 2016) below a dielectric surface.

    The surface is that of a ``dielectric`` that gives back what rough facets lose; its normal points out of the body, and the body is all that is
    behind it, so that a mesh should be closed. Inside, light flies by an exponential of mean ``radius`` and is scattered by Henyey and Greenstein's
    phase function. A thick body without a surface (``ior`` 1) reflects ``albedo`` of diffuse light: the albedo of one scattering event comes from
    van de Hulst's fit, inverted as by Kulla & Conty 2017 and OpenPBR 1.1, good to about 0.01. Textures are looked up where a path enters. Every
    meeting with a surface counts for ``max_depth``, the scattering between them does not; after 1024 events without such a meeting light goes
    straight on to the surface. Lights inside of a body are found by paths alone, so that point-like ones are not seen from there.
    """

    type: ClassVar[str] = "subsurface"
    reflective: ClassVar[bool] = False
    refracts: ClassVar[bool] = True

    albedo: Spectrum | Any = spectrum(0.8, high=1.0, textured=True, doc="fraction of diffuse light that a thick body reflects")
    radius: Spectrum | Any = spectrum((1e-3, 5e-4, 2.5e-4), textured=True, doc="mean free path, metres")
    ior: float | Any = number(1.4, low=0.0, low_open=True, textured=True, doc="index of refraction, inside over outside; bounded to 0.001 … 1000")
    roughness: float | Any = number(0.3, low=0.0, high=1.0, textured=True, doc="of the surface: 0 (clear, and then dark but for lights that paths "
                                                                             "meet, as glass is) to 1")
    g: float = number(0.0, low=-1.0, low_open=True, high=1.0, high_open=True, doc="mean cosine of the scattering angle: backward, even (0), "
                                                                                  "forward; bounded to ±0.99")

    @property
    def purely_specular(self) -> bool:  # type: ignore[override]
        return is_smooth(self.roughness)

    @property
    def device_kind(self) -> str:
        return "subsurface" if self.purely_specular else "rough_subsurface"

    @property
    def device_parameters(self) -> dict[str, str]:  # type: ignore[override]
        smooth = {"albedo": "spectrum", "radius": "spectrum", "ior": "number", "g": "number"}
        return smooth if self.purely_specular else smooth | {"roughness": "number"}

    @property
    def device_features(self) -> tuple[str, ...]:  # type: ignore[override]
        return ("WALKS",) if self.purely_specular else ("WALKS", "ENERGY_COMPENSATION")

    @property
    def energy_tolerance(self) -> float:  # type: ignore[override]
        return 0.0 if self.purely_specular else 0.005

    @classmethod
    def examples(cls) -> list[Material]:
        return [
            cls(albedo=(0.8, 0.5, 0.3)),
            cls(albedo=(1.0, 1.0, 1.0), roughness=0.0),
            cls(ior=1.0, roughness=0.0, g=0.8),
            cls(ior=1.6, roughness=0.7, g=-0.5),
        ]
