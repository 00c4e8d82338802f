"""Lights: one file a kind; those that are not shapes are mirrored by ``cl/light/NAME.cl``.

An area light is a shape that emits. Emitting shapes are sampled through ``cl/light/shape.cl`` by the shape's own sampling routine.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lumiere.registry import Registry

if TYPE_CHECKING:
    from lumiere.shape import Shape


@dataclass(kw_only=True)
class Light:
    """A light that is not a shape of the scene.

    ``device_kind`` names its file in ``cl/light``; ``record`` is the dtype of what that reads, filled by ``device_record``. ``arrays`` gives
    further buffers (name → array). ``delta``: rays cannot meet it by chance. ``infinite``: rays that leave the scene may meet it.
    ``lower`` returns the shape that stands for the light, where there is one.
    """

    type: ClassVar[str]
    record: ClassVar[np.dtype] = np.dtype([])
    name: str = ""

    @property
    def device_kind(self) -> str:
        """Name of the file in ``cl/light``."""
        return self.type

    @property
    def infinite(self) -> bool:
        """Rays that leave the scene may meet it."""
        return False

    def device_record(self) -> dict[str, Any]:
        """Values of ``record``'s fields."""
        return {}

    def arrays(self) -> dict[str, np.ndarray]:
        """Buffers beside the record."""
        return {}

    def flux(self, scene_radius: float) -> float:
        """Emitted power, W, as far as it matters to a scene of ``scene_radius`` metres; for choosing between lights."""
        raise NotImplementedError

    def lower(self) -> Shape | None:
        """The emitting shape that stands for this light, or None."""
        return None


def luminance(rgb: Any) -> float:
    """Y of linear Rec. 709."""
    return float(np.dot(np.asarray(rgb, dtype=np.float64), (0.2126, 0.7152, 0.0722)))


LIGHTS: Registry[Light] = Registry("lumiere.light", "light")
