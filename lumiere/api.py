"""Loading and rendering from Python."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from lumiere.errors import UsageError
from lumiere.film.image import Image
from lumiere.film.progress import Progress
from lumiere.scene.load import load
from lumiere.scene.model import Scene


def with_options(scene: Scene, options: dict[str, Any]) -> Scene:
    """A copy of ``scene`` with what the call asks for in place of the file's. Raises UsageError for a value out of range."""
    from lumiere.scene.fields import fields_of

    parts = {"spp": "sampler", "seed": "sampler", "width": "film", "height": "film", "crop": "film", "max_depth": "integrator"}
    for name, value in options.items():
        if value is None:
            continue
        part = getattr(scene, parts[name])
        field = fields_of(type(part))[name]
        values = value if name == "crop" else [value]
        if any((field.low is not None and v < field.low) or (field.high is not None and v > field.high) for v in values):
            raise UsageError(f"{name}: found {value}, expected {'whole numbers' if name == 'crop' else 'a whole number'} "
                             f"from {field.low:.0f} to {field.high:.0f}")
        scene = dataclasses.replace(scene, **{parts[name]: dataclasses.replace(part, **{name: tuple(value) if name == "crop" else value})})
    complaint = scene.film.check()
    if complaint:
        raise UsageError(complaint)
    return scene


def render(scene: Scene | str | Path | dict[str, Any], *, spp: int | None = None, seed: int | None = None, device: str | int | None = None,
           width: int | None = None, height: int | None = None, crop: tuple[int, int, int, int] | None = None, max_depth: int | None = None,
           time_limit: float | None = None, target_error: float | None = None,
           progress: Callable[[Progress], None] | None = None, stop: Callable[[], bool] | None = None) -> Image:
    """Renders ``scene`` (a Scene, or what ``load`` takes) and returns its Image.

    Each option stands in for the scene's own. ``time_limit`` (seconds, > 0) and ``stop`` (asked between batches) end the render early, with every
    pixel having got the same number of samples; at least one is always taken. With ``target_error`` (> 0) samples are taken until the picture's
    relative error (docs/goal.md) is below it, at most ``spp`` a pixel where that is given; the record says what came of it.

    Raises LumiereError with one line that says what is wrong.
    """
    begin = time.perf_counter()
    loaded = load(scene) if not isinstance(scene, Scene) else scene
    options = {"spp": spp, "seed": seed, "width": width, "height": height, "crop": crop, "max_depth": max_depth}
    loaded = with_options(loaded, options)
    if time_limit is not None and not time_limit > 0.0:
        raise UsageError(f"time_limit: found {time_limit}, expected seconds above 0")
    if target_error is not None and not target_error > 0.0:
        raise UsageError(f"target_error: found {target_error}, expected a number above 0")
    from lumiere.rendering import MOST_SAMPLES, Render

    job = Render(loaded, device, load_seconds=time.perf_counter() - begin)
    job.run(time_limit=time_limit, progress=progress, stop=stop, target_error=target_error, spp_limit=spp or MOST_SAMPLES)
    options |= {"device": device, "time_limit": time_limit, "target_error": target_error}
    return job.image({name: value for name, value in options.items() if value is not None})


__all__ = ["load", "render"]
