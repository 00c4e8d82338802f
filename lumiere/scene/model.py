"""The scene as objects: what a scene file says, validated, names resolved."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lumiere.errors import SceneError
from lumiere.filter import FILTERS, Filter
from lumiere.scene.fields import boolean, choice, choices, integer, kind, nested, number, vector

if TYPE_CHECKING:
    from lumiere.bsdf import Material
    from lumiere.camera import Camera
    from lumiere.light import Light
    from lumiere.shape import Shape
    from lumiere.texture import Texture

AOVS = ("albedo", "normal", "depth", "position", "uv", "material_id", "object_id", "sample_count", "variance", "direct", "indirect", "emission")


@dataclass(kw_only=True)
class Film:
    """The picture: pixel (0, 0) is the top left."""

    width: int = integer(512, low=1, high=65536, doc="pixels")
    height: int = integer(512, low=1, high=65536, doc="pixels")
    crop: tuple[int, int, int, int] | None = vector(None, size=4, low=0, high=65536, integers=True, nullable=True,
                                                    doc="x0, y0, x1, y1 in pixels: what is rendered, x1 and y1 excluded (default: all)")
    filter: Filter = kind(FILTERS, "box", doc="reconstruction filter")
    aovs: tuple[str, ...] = choices(AOVS, doc="further layers")
    exposure: float = number(0.0, low=-64.0, high=64.0, doc="stops, for PNG and JPEG; EXR holds the radiance unchanged")
    tonemap: str = choice("none", ["none", "aces", "agx", "filmic"], doc="for PNG and JPEG")

    def check(self) -> str | None:
        """What is wrong with the crop, or None."""
        if self.crop is None:
            return None
        x0, y0, x1, y1 = self.crop
        if x0 >= x1 or y0 >= y1 or x1 > self.width or y1 > self.height:
            return (f"found the crop {list(self.crop)}, expected [x0, y0, x1, y1] with x0 < x1 and y0 < y1 inside the film of "
                    f"{self.width} × {self.height} pixels")
        return None

    @property
    def window(self) -> tuple[int, int, int, int]:
        """x0, y0, x1, y1 of what is rendered."""
        return (0, 0, self.width, self.height) if self.crop is None else self.crop


@dataclass(kw_only=True)
class Integrator:
    """What is computed along a path."""

    type: str = choice("path", ["path", "bdpt", "direct", "ambient_occlusion"], doc="the algorithm")
    max_depth: int = integer(16, low=0, high=65535, doc="the most scattering events on a path: 0 = emitters seen directly, 1 = direct light")
    russian_roulette_depth: int | None = integer(5, low=0, high=65535, nullable=True, doc="roulette starts behind this event; null = never")
    light_sampling: str = choice("mis", ["mis", "light", "bsdf"], doc="how direct light is found")
    clamp_indirect: float | None = number(None, low=0.0, low_open=True, nullable=True, doc="largest indirect sample; null = off, else a bias")
    energy_compensation: bool = boolean(True, doc="rough surfaces give back the light that meets their facets more than once")


@dataclass(kw_only=True)
class Adaptive:
    """Where more samples go."""

    target_error: float = number(low=0.0, low_open=True, doc="relative standard error, root mean square over the pixels")
    max_spp: int = integer(low=1, high=2**31 - 1, doc="samples a pixel at most")


@dataclass(kw_only=True)
class Sampler:
    """Where the random numbers come from. The same seed gives the same picture, bit by bit."""

    type: str = choice("sobol", ["sobol", "independent", "stratified"], doc="sobol is Owen-scrambled")
    spp: int = integer(64, low=1, high=2**31 - 1, doc="samples a pixel")
    seed: int = integer(0, low=0, high=2**32 - 1, doc="another seed, another picture of the same expectation")
    adaptive: Adaptive | None = nested(Adaptive, nullable=True, doc="sample until an error is reached")


@dataclass(kw_only=True)
class Scene:
    """A scene. A texture or material that has a name is one object, shared by all that use the name.

    ``camera`` is None where the file has none; a shape's ``material`` and ``emission`` are None where it gives none.
    ``path`` is the scene's file, None for a dict; ``text_hash`` the SHA-256, in hexadecimal digits, of its bytes.
    """

    path: Path | None = None
    text_hash: str = ""
    camera: Camera | None = None
    film: Film = field(default_factory=Film)
    integrator: Integrator = field(default_factory=Integrator)
    sampler: Sampler = field(default_factory=Sampler)
    materials: dict[str, Material] = field(default_factory=dict)
    textures: dict[str, Texture] = field(default_factory=dict)
    geometry: list[Shape] = field(default_factory=list)
    lights: list[Light] = field(default_factory=list)
    places: dict[int, str] = field(default_factory=dict, repr=False, compare=False)

    def place(self, thing: Any) -> str:
        """Where ``thing``, a camera, material, texture, shape, light or file of this scene, was read: ``FILE:LINE:COLUMN: PATH``, for messages.

        Without a file it is the path alone; ``"the scene"`` for what was not read.
        """
        return self.places.get(id(thing), "the scene")

    @contextlib.contextmanager
    def placing_errors(self) -> Iterator[None]:
        """Within the block a SceneError about something of this scene begins with its place."""
        try:
            yield
        except SceneError as error:
            if id(error.about) not in self.places:
                raise
            raise SceneError(f"{self.place(error.about)}: {error}") from None
