"""The constant texture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lumiere.scene.fields import Spectrum, spectrum
from lumiere.texture import TEXTURES, Texture

if TYPE_CHECKING:
    from lumiere.compile.textures import TexelStore


@TEXTURES.register
@dataclass(kw_only=True)
class ConstantTexture(Texture):
    """The same value everywhere: a named colour that several materials share."""

    type: ClassVar[str] = "constant"
    record: ClassVar[Any] = np.dtype([("value", "<f4", 3)])

    value: Spectrum = spectrum(0.5, doc="the value")

    def device_record(self, texels: TexelStore) -> dict[str, Any]:
        return {"value": self.value}

    def average(self) -> tuple[float, float, float]:
        return self.value
