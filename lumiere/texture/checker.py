"""The checkerboard."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lumiere.scene.fields import Spectrum, spectrum, vector
from lumiere.texture import TEXTURES, Texture

if TYPE_CHECKING:
    from lumiere.compile.textures import TexelStore


@TEXTURES.register
@dataclass(kw_only=True)
class CheckerTexture(Texture):
    """Cells of two values: ``a`` where the sum of the cell's two indices is even, else ``b``."""

    type: ClassVar[str] = "checker"
    record: ClassVar[Any] = np.dtype([("a", "<f4", 3), ("b", "<f4", 3), ("scale", "<f4", 2)])
    uses: ClassVar[tuple[str, ...]] = ("uv",)

    a: Spectrum = spectrum(0.4, doc="value of the even cells")
    b: Spectrum = spectrum(0.2, doc="value of the odd cells")
    scale: tuple[float, float] = vector((1.0, 1.0), size=2, broadcast=True, doc="cells per unit of uv: a number, or one for u and one for v")

    def device_record(self, texels: TexelStore) -> dict[str, Any]:
        return {"a": self.a, "b": self.b, "scale": self.scale}

    def average(self) -> tuple[float, float, float]:
        return tuple((a + b) / 2.0 for a, b in zip(self.a, self.b, strict=True))  # type: ignore[return-value]
