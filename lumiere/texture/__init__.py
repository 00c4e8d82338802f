"""Textures: one file a kind, each mirrored by ``cl/texture/NAME.cl``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lumiere.registry import Registry

if TYPE_CHECKING:
    from lumiere.compile.textures import TexelStore


@dataclass(kw_only=True)
class Texture:
    """A value that varies over a surface.

    ``record`` is the numpy dtype of what ``NAME_texture(scene, index, surface)`` in ``cl/texture/NAME.cl`` reads; ``device_record`` fills it.
    ``uses`` names what the kind reads of the surface: ``uv``, ``color``, ``footprint``. ``average`` is the mean value over uv, for light power.
    """

    type: ClassVar[str]
    record: ClassVar[Any] = np.dtype([])
    uses: ClassVar[tuple[str, ...]] = ()
    name: str = ""

    def device_record(self, texels: TexelStore) -> dict[str, Any]:
        """Values of ``record``'s fields; pictures go into ``texels``."""
        return {}

    def average(self) -> tuple[float, float, float]:
        """Mean linear Rec. 709 value over the unit square of uv."""
        raise NotImplementedError


TEXTURES: Registry[Texture] = Registry("lumiere.texture", "texture")
