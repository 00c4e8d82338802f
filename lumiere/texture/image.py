"""Pictures as textures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lumiere.scene.fields import Spectrum, choice, file, spectrum, vector
from lumiere.texture import TEXTURES, Texture

if TYPE_CHECKING:
    from lumiere.compile.textures import TexelStore

WRAPS = ("repeat", "clamp", "mirror")
FILTERS = ("bilinear", "nearest", "mipmap")
CHANNELS = ("rgb", "r", "g", "b", "a")


@TEXTURES.register
@dataclass(kw_only=True)
class ImageTexture(Texture):
    """A picture; uv (0, 0) is its bottom left. The lookup is at uv × ``scale`` + ``offset``."""

    type: ClassVar[str] = "image"
    record: ClassVar[Any] = np.dtype([
        ("first", "<u4"), ("width", "<i4"), ("height", "<i4"), ("format", "<i4"), ("wrap", "<i4"), ("filter", "<i4"), ("channel", "<i4"),
        ("scale", "<f4", 2), ("offset", "<f4", 2), ("factor", "<f4", 3)])

    file: Any = file(None, nullable=True, doc="the picture: PNG, JPEG, HDR, EXR, TIFF, …")
    encoding: str | None = choice(None, ["srgb", "linear"], nullable=True, doc="of the values (default: srgb for 8-bit integers, else linear)")
    wrap: str = choice("repeat", WRAPS, doc="what is beyond [0, 1]")
    filter: str = choice("bilinear", FILTERS, doc="between texels; mipmap: bilinear, and over what a path's cone covers where that is more")
    scale: tuple[float, float] = vector((1.0, 1.0), size=2, broadcast=True, doc="repetitions per unit of uv: a number, or one for u and one for v")
    offset: tuple[float, float] = vector((0.0, 0.0), size=2, doc="added to uv after scale")
    channel: str = choice("rgb", CHANNELS, doc="rgb, or one channel as a grey value")
    factor: Spectrum = spectrum(1.0, doc="multiplies the value")
    pixels: np.ndarray | None = field(default=None, repr=False, compare=False)
    """(h, w, c) uint8 or float32 in place of ``file``, for pictures inside a mesh file; row 0 at the top."""

    @property
    def uses(self) -> tuple[str, ...]:  # type: ignore[override]
        return ("uv", "footprint") if self.filter == "mipmap" else ("uv",)

    def check(self) -> str | None:
        """What is wrong with the texture, or None."""
        return "found no file, expected the name of a picture" if self.file is None and self.pixels is None else None

    def load(self) -> np.ndarray:
        """(h, w, c) uint8 or float32, row 0 at the top."""
        if self.pixels is None:
            from lumiere.imagefile import read_image

            self.pixels = read_image(self.file)
        return self.pixels

    def device_record(self, texels: TexelStore) -> dict[str, Any]:
        pixels = self.load()
        first, texel_format = texels.add(self, pixels)
        return {"first": first, "width": pixels.shape[1], "height": pixels.shape[0], "format": texel_format, "wrap": WRAPS.index(self.wrap),
                "filter": FILTERS.index(self.filter), "channel": CHANNELS.index(self.channel) - 1, "scale": self.scale, "offset": self.offset,
                "factor": self.factor}

    def average(self) -> tuple[float, float, float]:
        from lumiere.compile.textures import linear_rgb

        mean = linear_rgb(self.load(), self.encoding).reshape(-1, 3).mean(axis=0, dtype=np.float64) * self.factor
        return (float(mean[0]), float(mean[1]), float(mean[2]))
