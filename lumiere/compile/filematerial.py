"""Materials of mesh files → materials of ours."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from lumiere.bsdf import Material
from lumiere.bsdf.plastic import Plastic
from lumiere.bsdf.conductor import Conductor
from lumiere.texture.image import ImageTexture

if TYPE_CHECKING:
    from lumiere.meshfile import FileMaterial
