"""Materials: one file a kind, each mirrored by ``cl/bsdf/NAME.cl``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.registry import Registry
from lumiere.scene.fields import Spectrum, boolean, choice, number, spectrum, texture

SMOOTH_ROUGHNESS = 0.01
"""Below this perceptual roughness a surface is shaded as a smooth one: ``cl/lib/microfacet.cl`` says why."""


def is_smooth(roughness: float | Any) -> bool:
    """Is a material of this roughness smooth everywhere? One with a texture may be rough somewhere."""
    return isinstance(roughness, (int, float)) and roughness < SMOOTH_ROUGHNESS


@dataclass(frozen=True)
class Body:
    """What a surface bounds, where bodies overlap: the one of the highest ``priority`` is there. ``ior`` is absolute; ``absorption`` is in 1/m."""

    priority: int
    ior: float
    absorption: tuple[float, float, float]


@dataclass(kw_only=True)
class Material:
    """What every material may carry.

    A subclass declares its own JSON keys as fields, and for the device:

    * ``device_parameters``: names and kinds (``"number"`` or ``"spectrum"``) of what its BSDF's functions take;
    * ``device_values``: those parameters' values, each a float, a spectrum or a texture (default: the attributes of the same names);
    * ``device_kind``: the BSDF that shades it (default: ``type``);
    * ``purely_specular``: all of its lobes are Dirac deltas;
    * ``examples``: a few materials of the kind that show its range, for the tests and the reference.

    What depends on the values (smooth or rough, say) is a property of the same name: ask the instance, not the class.
    """

    type: ClassVar[str]
    device_parameters: ClassVar[dict[str, str]] = {}
    purely_specular: ClassVar[bool] = False
    refracts: ClassVar[bool] = False
    """Radiance is scaled where it crosses the surface."""
    device_features: ClassVar[tuple[str, ...]] = ()
    """Macros with which its BSDF is compiled: lobes that it has. A kind is compiled with those of all the materials in the scene."""
    compensates: ClassVar[bool] = False
    """Its BSDF knows the macro ``ENERGY_COMPENSATION``, which the scene asks for: it gives back what rough facets lose."""
    energy_tolerance: ClassVar[float] = 0.0
    """How far from exact its tables leave what it scatters in all."""
    reflective: ClassVar[bool] = True
    """Scatters on one side only, and so is two-sided unless the file says otherwise."""

    name: str = ""
    emission: Spectrum | Any = spectrum(0.0, textured=True, doc="emitted radiance, W m⁻² sr⁻¹")
    emission_sides: str = choice("front", ["front", "both"], doc="the side that the normal points to, or both")
    opacity: float | Any = number(1.0, low=0.0, high=1.0, textured=True, doc="fraction of rays that see the surface")
    normal_map: Any = texture(doc="tangent-space normal, rgb in [0, 1] for xyz in [-1, 1]")
    bump_map: Any = texture(doc="height whose gradient tilts the normal")
    bump_scale: float = number(1.0, doc="metres of height per unit of the bump map")
    two_sided: bool | None = boolean(None, nullable=True, doc="scatters on both sides (default: true for reflective kinds)")

    @property
    def device_kind(self) -> str:
        """Name of the BSDF in ``cl/bsdf`` that shades this material."""
        return self.type

    @property
    def needs_tangent(self) -> bool:
        """Its shading depends on how the surface's uv run: it is anisotropic, or tilted by a map."""
        return bool(getattr(self, "anisotropy", 0.0)) or self.normal_map is not None or self.bump_map is not None

    @property
    def body(self) -> Body | None:
        """The body that it bounds, where bodies nest by priority."""
        return None

    def device_values(self) -> dict[str, Any]:
        """The values of ``device_parameters``, by name."""
        return {name: getattr(self, name) for name in self.device_parameters}

    def check(self) -> str | None:
        """A complaint about values that exclude each other, or None."""
        return None

    @classmethod
    def examples(cls) -> list[Material]:
        """Materials of this kind that show its range."""
        return [cls()]


MATERIALS: Registry[Material] = Registry("lumiere.bsdf", "material")
