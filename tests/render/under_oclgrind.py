"""Renders a tiny scene on the device that there is; tests/render/test_oclgrind.py runs this in Oclgrind's process.

    under_oclgrind.py FOLDER dense|compacted [without-triangles | in-lanes]
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyopencl as cl

import lumiere
import lumiere.rendering
from lumiere.wavefront.policy import policy_for
from tests.render.card import write_exr


def _fill_by_copy(queue: Any, buffer: Any, pattern: Any, offset: int, size: int) -> Any:
    """Oclgrind's check for uninitialised values does not see what clEnqueueFillBuffer writes."""
    return cl.enqueue_copy(queue, buffer, np.full(size // pattern.itemsize, pattern), dst_offset=offset)


def in_lanes(lamp: dict[str, Any]) -> dict[str, Any]:
    """A scene that is shaded sixteen paths at once (cl/lib/lanes.cl), with lights of kinds that are, and one that is not."""
    return {"camera": {"position": [0, 1, 4], "look_at": [0, 0, 0]}, "film": {"width": 8, "height": 8}, "sampler": {"spp": 1},
            "integrator": {"max_depth": 3, "russian_roulette_depth": 1},
            "geometry": [{"type": "box", "min": [-3, -2, -3], "max": [3, -0.5, 3]}, lamp | {"emission": 5}],
            "lights": [{"type": "environment", "radiance": 0.5}, {"type": "point", "position": [1, 1, 1], "intensity": 1}]}


def main(folder: Path, queues: str, *options: str) -> None:
    cl.enqueue_fill_buffer = _fill_by_copy
    lumiere.rendering.policy_for = lambda *arguments: replace(policy_for(*arguments), compacted=queues == "compacted", slots=64, work_group=32)
    texels = np.random.default_rng(1).random((2, 4, 3))
    lamp = {"type": "rectangle", "transform": [{"scale": 0.4}, {"rotate": {"axis": [1, 0, 0], "angle": 90}}, {"translate": [0, 2, 0]}]}
    if "without-triangles" in options:
        lamp = {"type": "disk", "position": [0, 2, 0], "normal": [0, -1, 0], "radius": 0.4}
    if "in-lanes" in options:
        image = lumiere.render({"scene": in_lanes(lamp)}, device="oclgrind")
        sys.stdout.write(f"rendered: mean {image.pixels.mean()}, {image.record['rays']['shadow']} shadow rays\n")
        return
    image = lumiere.render({"scene": {
        "camera": {"position": [0, 1, 4], "look_at": [0, 0, 0]}, "film": {"width": 8, "height": 8}, "sampler": {"spp": 1},
        "integrator": {"max_depth": 3, "russian_roulette_depth": 1},
        "materials": {"glass": {"type": "dielectric"}, "floor": {"type": "lambert", "albedo": {"type": "image", "file": write_exr(folder / "t.exr", texels)}}},
        "geometry": [{"type": "sphere", "radius": 0.6, "material": "glass"}, {"type": "plane", "position": [0, -0.7, 0], "material": "floor"},
                     lamp | {"emission": 5}],
        "lights": [{"type": "environment", "file": write_exr(folder / "e.exr", texels)}]}}, device="oclgrind")
    sys.stdout.write(f"rendered: mean {image.pixels.mean()}, {image.record['rays']['shadow']} shadow rays\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:])
