"""Mix."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from lumiere.bsdf import MATERIALS, Material
from lumiere.scene.fields import material, number
from lumiere.texture import Texture


@MATERIALS.register
@dataclass(kw_only=True)
class Mix(Material):
    """Two materials in one: ``b`` at a fraction ``weight`` of the surface, ``a`` at the rest; they may be mixes themselves.

    Where a path meets it, one of the two is chosen at random, so that each is shaded as if it were alone, and the mean is the mixture.
    Emission and opacity are the mix's own; so are the normal and bump map where a part has none.
    """

    type: ClassVar[str] = "mix"

    a: Material | None = material(doc="name of a material, or a material")
    b: Material | None = material(doc="name of the other, or the other")
    weight: float | Any = number(0.5, low=0.0, high=1.0, textured=True, doc="0 (a alone) to 1 (b alone)")

    def check(self) -> str | None:
        for name, part in (("a", self.a), ("b", self.b)):
            if part is None:
                return f"found no '{name}', expected a material (a name or an object with a type)"
            if isinstance(part.emission, Texture) or any(part.emission):
                return f"found that '{name}' emits, expected emission of the mix itself: move 'emission' from the part to the mix"
            if isinstance(part.opacity, Texture) or part.opacity < 1.0:
                return f"found that '{name}' is not opaque, expected opacity of the mix itself: move 'opacity' from the part to the mix"
        return None

    @classmethod
    def examples(cls) -> list[Material]:
        return []
