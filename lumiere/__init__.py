"""Lumière: a portable path tracer on OpenCL.

>>> import lumiere
>>> image = lumiere.render("scenes/cornell.json", spp=16)  # doctest: +SKIP
>>> image.save("cornell.exr")  # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from lumiere.errors import DeviceError, LumiereError, SceneError, UsageError

if TYPE_CHECKING:
    from lumiere.api import load, render
    from lumiere.film.image import Image
    from lumiere.scene.model import Scene

__version__ = "0.1.0"

__all__ = ["DeviceError", "Image", "LumiereError", "Scene", "SceneError", "UsageError", "__version__", "load", "render"]

_LAZY = {"load": "lumiere.api", "render": "lumiere.api", "Image": "lumiere.film.image", "Scene": "lumiere.scene.model"}


def __getattr__(name: str) -> Any:
    """Imports what is asked for when it is asked for, so that ``import lumiere`` stays quick."""
    if name in _LAZY:
        import importlib

        return getattr(importlib.import_module(_LAZY[name]), name)
    raise AttributeError(f"module 'lumiere' has no attribute '{name}'")
