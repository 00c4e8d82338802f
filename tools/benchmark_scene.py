"""The benchmark's scenes: displaced icospheres on a ground plane under a constant sky, at any number of triangles.

    python tools/benchmark_scene.py OUT [--faces 20480] [--spheres 50]

writes OUT.ply and OUT.json: 50 spheres of 20,480 faces are 1,024,002 triangles with the ground.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
import trimesh


def displaced_spheres(spheres: int, faces: int, seed: int = 1) -> trimesh.Trimesh:
    """Icospheres of ``faces`` = 20 · 4ᵏ triangles, radius 0.4–0.9 m, displaced by 8 %, centres in [−8, 8] × [0.5, 4] × [−8, 8], and a 60 m ground."""
    rng = np.random.default_rng(seed)
    unit = trimesh.creation.icosphere(subdivisions=round(np.log(faces / 20) / np.log(4)))
    directions = unit.vertices / np.linalg.norm(unit.vertices, axis=1, keepdims=True)
    vertices, triangles = [], []
    for number in range(spheres):
        waves = rng.normal(size=(3, 3)) * 6.0
        bumps = np.sin(directions @ waves.T + rng.uniform(0.0, 2.0 * np.pi, 3)).mean(axis=1)
        radius = rng.uniform(0.4, 0.9) * (1.0 + 0.08 * bumps)
        center = rng.uniform((-8.0, 0.5, -8.0), (8.0, 4.0, 8.0))
        vertices.append(center + directions * radius[:, None])
        triangles.append(unit.faces + number * len(directions))
    first = spheres * len(directions)
    vertices.append(np.array([[-30.0, 0.0, -30.0], [-30.0, 0.0, 30.0], [30.0, 0.0, 30.0], [30.0, 0.0, -30.0]]))
    triangles.append(np.array([[0, 1, 2], [0, 2, 3]]) + first)
    return trimesh.Trimesh(np.concatenate(vertices), np.concatenate(triangles), process=False)


def scene(mesh: str, width: int, height: int) -> dict:
    """The scene around the mesh file ``mesh``: Lambert, sky of radiance 1, 7 scatterings, no roulette."""
    return {"scene": {
        "camera": {"position": [0, 6, 18], "look_at": [0, 1.5, 0], "fov": 50, "fov_axis": "x"},
        "film": {"width": width, "height": height},
        "integrator": {"max_depth": 7, "russian_roulette_depth": None},
        "materials": {"clay": {"type": "lambert", "albedo": 0.7}},
        "geometry": [{"type": "mesh", "file": mesh, "material": "clay", "smooth": False}],
        "lights": [{"type": "environment", "radiance": 1.0}]}}


def main() -> None:
    parser = argparse.ArgumentParser(description="Write a benchmark scene.")
    parser.add_argument("out", type=Path)
    parser.add_argument("--faces", type=int, default=20480, help="of a sphere: 20, 80, 320, … 20480")
    parser.add_argument("--spheres", type=int, default=50)
    parser.add_argument("--size", type=int, nargs=2, default=(480, 270))
    arguments = parser.parse_args()
    displaced_spheres(arguments.spheres, arguments.faces).export(arguments.out.with_suffix(".ply"))
    text = json.dumps(scene(arguments.out.with_suffix(".ply").name, *arguments.size), indent=1)
    arguments.out.with_suffix(".json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
