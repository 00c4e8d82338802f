"""Colours of a mesh's vertices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from lumiere.texture import TEXTURES, Texture


@TEXTURES.register
@dataclass(kw_only=True)
class VertexColorTexture(Texture):
    """The colours that a mesh's file gives its vertices, interpolated over each triangle; white where there are none."""

    type: ClassVar[str] = "vertex_color"
    uses: ClassVar[tuple[str, ...]] = ("color",)

    def average(self) -> tuple[float, float, float]:
        return (1.0, 1.0, 1.0)
