"""The picture that a render returns."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from lumiere.film.write import check_output, write

__all__ = ["Image", "check_output"]


@dataclass(kw_only=True, repr=False)
class Image:
    """A rendered picture, or the part of it inside ``crop``; row 0 is the top.

    An Image is an array to numpy: ``numpy.asarray(image)`` is its ``pixels``.
    """

    pixels: np.ndarray
    """(h, w, 3) float32: scene-linear Rec. 709 radiance, W m⁻² sr⁻¹."""
    variance: np.ndarray | None = None
    """(h, w, 3) float32: variance of each pixel's mean (its standard error, squared)."""
    aovs: dict[str, np.ndarray] = field(default_factory=dict)
    """Further layers by name, (h, w) or (h, w, c); each goes into an EXR."""
    record: dict[str, Any] = field(default_factory=dict)
    """How it was made."""
    crop: tuple[int, int, int, int] | None = None
    """x0, y0, x1, y1: the pixels' place in the whole picture, half-open; None stands for all of it."""
    full_size: tuple[int, int] | None = None
    """Width and height of the whole picture; None stands for that of ``pixels``, if there is no crop."""

    def __post_init__(self) -> None:
        if self.pixels.ndim != 3 or self.pixels.shape[2] != 3:
            raise ValueError(f"found pixels of shape {self.pixels.shape}, expected (height, width, 3)")
        height, width = self.pixels.shape[:2]
        if self.crop is None:
            self.crop = (0, 0, width, height)
        x0, y0, x1, y1 = self.crop
        if (x1 - x0, y1 - y0) != (width, height):
            raise ValueError(f"found {width} × {height} pixels, expected the {x1 - x0} × {y1 - y0} of crop {list(self.crop)}")
        if self.full_size is None:
            self.full_size = (x1, y1) if (x0, y0) == (0, 0) else None
        if self.full_size is None or x1 > self.full_size[0] or y1 > self.full_size[1]:
            raise ValueError(f"found crop {list(self.crop)} and full_size {self.full_size}, expected the whole picture's width and height")

    @property
    def width(self) -> int:
        return self.pixels.shape[1]

    @property
    def height(self) -> int:
        return self.pixels.shape[0]

    def save(self, path: str | os.PathLike[str], exposure: float = 0.0, tonemap: str = "none") -> None:
        """Writes the picture in the format of the suffix: ``.exr``, ``.png``, ``.jpg`` or ``.jpeg``; whole or not at all.

        An EXR holds the radiance unchanged, every AOV as a layer, and the record. PNG and JPEG hold 8-bit sRGB after ``exposure``
        (stops) and ``tonemap`` (``none``, ``aces``, ``agx`` or ``filmic``). Raises UsageError for a path that cannot be, LumiereError
        where the writing fails.
        """
        write(self, path, exposure, tonemap)

    def _repr_png_(self) -> bytes:
        """The picture as PNG bytes, for notebooks."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "image.png"
            self.save(path)
            return path.read_bytes()

    def __repr__(self) -> str:
        return f"<lumiere Image {', '.join([f'{self.width} × {self.height}', *self.aovs])}>"

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        converts = dtype is not None and np.dtype(dtype) != self.pixels.dtype
        if copy is False and converts:
            raise ValueError(f"an Image's pixels are {self.pixels.dtype}, which takes a copy to become {np.dtype(dtype)}")
        return np.array(self.pixels, dtype=dtype) if copy or converts else self.pixels
