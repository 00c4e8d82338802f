"""The panorama camera."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from lumiere.camera import CAMERAS, Camera


@CAMERAS.register
@dataclass(kw_only=True)
class Panorama(Camera):
    """All directions as a lat-long picture: the centre column looks down −Z, columns run to the right, rows from +Y to −Y."""

    type: ClassVar[str] = "panorama"
