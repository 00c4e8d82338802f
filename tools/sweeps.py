"""Renders a row of spheres for each of the materials' parameters, from one end of it to the other: the picture of the README.

    python tools/sweeps.py docs/images/sweeps.jpg [--spp 256] [--device D]

The rows, from the top: gold's, glass' and plastic's roughness; then of `principled`: `metallic`, `specular`, `anisotropy`, `clearcoat`, `sheen`,
`transmission`, `subsurface`; then glass' `abbe_number`, and the `weight` of a mix of copper with green paint.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import lumiere

COLUMNS = 7
PIXELS = 64
"""From one sphere to the next."""

Json = dict[str, Any]


def principled(**keys: object) -> Json:
    return {"type": "principled", "base_color": [0.75, 0.2, 0.08], **keys}


def rows() -> list[list[Json]]:
    """The materials of each row, from the left to the right."""
    steps = [i / (COLUMNS - 1) for i in range(COLUMNS)]
    copper, paint = {"type": "conductor", "metal": "copper", "roughness": 0.3}, {"type": "lambert", "albedo": [0.1, 0.4, 0.2]}
    sweeps = [
        lambda x: {"type": "conductor", "metal": "gold", "roughness": x},
        lambda x: {"type": "dielectric", "roughness": x},
        lambda x: {"type": "plastic", "albedo": [0.1, 0.3, 0.6], "roughness": x},
        lambda x: principled(metallic=x, roughness=0.25),
        lambda x: principled(specular=x, roughness=0.15),
        lambda x: principled(metallic=1, roughness=0.35, anisotropy=x),
        lambda x: principled(clearcoat=x, roughness=0.7),
        lambda x: principled(sheen=x, roughness=0.8),
        lambda x: principled(transmission=x, roughness=0.1),
        lambda x: principled(subsurface=x, roughness=0.3, subsurface_radius=[0.3, 0.1, 0.05]),
        lambda x: {"type": "dielectric", "ior": 1.7, "abbe_number": 95.0 * (4.0 / 95.0) ** x},
        lambda x: {"type": "mix", "a": copper, "b": paint, "weight": x},
    ]
    return [[sweep(x) for x in steps] for sweep in sweeps]


def scene() -> Json:
    """All of them before a checkered wall, under a grey sky with a large lamp."""
    materials = rows()
    height = float(len(materials))
    spheres = [{"type": "sphere", "position": [x - 0.5 * (COLUMNS - 1), 0.5 * (height - 1.0) - y, 0.0], "radius": 0.45, "material": material}
               for y, row in enumerate(materials) for x, material in enumerate(row)]
    wall = {"type": "rectangle", "transform": [{"scale": [24, 24, 1]}, {"translate": [0, 0, -3]}],
            "material": {"type": "lambert", "albedo": {"type": "checker", "a": 0.5, "b": 0.2, "scale": 64}}}
    return {"scene": {
        "camera": {"type": "orthographic", "position": [0, 0, 20], "look_at": [0, 0, 0], "height": height},
        "film": {"width": COLUMNS * PIXELS, "height": len(materials) * PIXELS, "filter": {"type": "gaussian"}}, "integrator": {"max_depth": 24},
        "geometry": [*spheres, wall],
        "lights": [{"type": "environment", "radiance": 0.35}, {"type": "area", "position": [-12, 14, 20], "radius": 5, "radiance": 6}]}}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path, help="EXR, PNG or JPEG")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--device")
    options = parser.parse_args()
    lumiere.render(scene(), spp=options.spp, device=options.device).save(options.output)


if __name__ == "__main__":
    main()
