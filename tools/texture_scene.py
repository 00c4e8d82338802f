"""A scene that asks for texture filtering: bricks on a ground that runs to the horizon, and on a wall, a mirror ball and a box among them.

    python tools/texture_scene.py OUT

writes OUT.png, 1024 × 1024 texels of bricks, and OUT.json; `lumiere tradeoff OUT.json` then measures `bilinear`, `nearest` and `mipmap`.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
import OpenImageIO

SIZE = 1024


def bricks(seed: int = 1) -> np.ndarray:
    """(1024, 1024, 3) uint8: sixteen rows of eight bricks, no two of a colour, with grain, in pale mortar."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    row = y // 64
    along = (x + 64 * (row % 2)) % SIZE
    colors = np.array([150.0, 70.0, 50.0]) * rng.uniform(0.5, 1.4, (16, 8, 1))
    picture = colors[row, along // 128] * rng.uniform(0.7, 1.3, (SIZE, SIZE, 1))
    mortar = (y % 64 < 6) | (along % 128 < 6)
    picture[mortar] = (200.0, 195.0, 185.0)
    return np.clip(picture, 0, 255).astype(np.uint8)


def scene(picture: str) -> dict:
    """The scene around the picture's file."""
    def wall(scale: float) -> dict:
        return {"type": "lambert", "albedo": {"type": "image", "file": picture, "scale": scale}}

    return {"scene": {
        "camera": {"position": [0, 1.6, 8], "look_at": [0, 1.2, 0], "fov": 50},
        "film": {"width": 128, "height": 128},
        "materials": {"ground": wall(100), "wall": wall(3), "white": {"type": "lambert", "albedo": 0.7}, "mirror": {"type": "mirror"}},
        "geometry": [
            {"type": "rectangle", "material": "ground", "transform": [{"scale": 100}, {"rotate": {"axis": [1, 0, 0], "angle": -90}}]},
            {"type": "rectangle", "material": "wall",
             "transform": [{"scale": 3}, {"rotate": {"axis": [0, 1, 0], "angle": 60}}, {"translate": [-4, 3, -1]}]},
            {"type": "sphere", "material": "mirror", "position": [0.3, 1, 1], "radius": 1},
            {"type": "box", "material": "white", "min": [2, 0, -1], "max": [4, 2.5, 1]}],
        "lights": [{"type": "environment", "radiance": 0.8},
                   {"type": "directional", "direction": [-0.5, -1, -0.6], "irradiance": 3}]}}


def main() -> None:
    parser = argparse.ArgumentParser(description="Write a scene that asks for texture filtering.")
    parser.add_argument("out", type=Path)
    arguments = parser.parse_args()
    picture = arguments.out.with_suffix(".png")
    OpenImageIO.ImageBuf(bricks()).write(str(picture))
    arguments.out.with_suffix(".json").write_text(json.dumps(scene(picture.name), indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
