"""The benchmark's scenes: displaced icospheres on a ground plane under a constant sky, at any number of triangles; long beams that cross each other; and
the Cornell box.

    python tools/benchmark_scene.py OUT [--faces 20480] [--spheres 50 | --beams N]

writes OUT.ply and OUT.json: 50 spheres of 20,480 faces are 1,024,002 triangles with the ground.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

CORNELL = Path(__file__).resolve().parent.parent / "scenes" / "cornell.json"


@dataclass(frozen=True)
class Spheres:
    """``spheres`` icospheres of ``faces`` triangles each, and whether the camera stands ``close`` to the lone one."""

    spheres: int
    faces: int
    close: bool = False


@dataclass(frozen=True)
class Beams:
    """``count`` long thin boxes, turned at random: what object splits do badly with."""

    count: int


SCENES: dict[str, Spheres | Beams | None] = {
    "million": Spheres(50, 20480), "20k": Spheres(1, 20480, close=True), "320": Spheres(1, 320), "20million": Spheres(61, 327680),
    "tiny": Spheres(3, 80), "beams": Beams(400), "cornell": None}
"""None: the Cornell box of ``scenes/``."""


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


def beams(count: int, seed: int = 1) -> trimesh.Trimesh:
    """Boxes of 2 × 0.02 × 0.02 m in uniform directions, centres in [−1, 1]³."""
    rng = np.random.default_rng(seed)
    made = []
    for _ in range(count):
        made.append(trimesh.creation.box((2.0, 0.02, 0.02), trimesh.transformations.random_rotation_matrix(rng.random(3))))
        made[-1].apply_translation(rng.uniform(-1.0, 1.0, 3))
    return trimesh.util.concatenate(made)


def camera(mesh: trimesh.Trimesh, close: bool) -> dict[str, Any]:
    """At (0, 6, 18), looking at (0, 1.5, 0); or, from the same side, so close to a lone sphere that it fills three quarters of a square's height."""
    if not close:
        return {"position": [0, 6, 18], "look_at": [0, 1.5, 0], "fov": 50, "fov_axis": "x"}
    sphere = mesh.vertices[:-4]
    center = (sphere.min(axis=0) + sphere.max(axis=0)) / 2.0
    radius = np.linalg.norm(sphere - center, axis=1).max()
    away = np.array([0.0, 4.5, 18.0]) / np.linalg.norm([0.0, 4.5, 18.0])
    return {"position": (center + 3.0 * radius * away).tolist(), "look_at": center.tolist(), "fov": 50, "fov_axis": "x"}


def scene(mesh: str, seen_by: dict[str, Any], width: int, height: int) -> dict[str, Any]:
    """The scene around the mesh file ``mesh``: Lambert, sky of radiance 1, 7 scatterings, no roulette."""
    return {"scene": {
        "camera": seen_by,
        "film": {"width": width, "height": height},
        "integrator": {"max_depth": 7, "russian_roulette_depth": None},
        "materials": {"clay": {"type": "lambert", "albedo": 0.7}},
        "geometry": [{"type": "mesh", "file": mesh, "material": "clay", "smooth": False}],
        "lights": [{"type": "environment", "radiance": 1.0}]}}


def write_made(out: Path, made: Spheres | Beams, size: tuple[int, int] = (480, 270)) -> Path:
    """Writes OUT.ply and OUT.json; returns the latter."""
    if isinstance(made, Beams):
        mesh, seen_by = beams(made.count), {"position": [0, 1, 5], "look_at": [0, 0, 0], "fov": 50, "fov_axis": "x"}
    else:
        mesh = displaced_spheres(made.spheres, made.faces)
        seen_by = camera(mesh, made.close)
    mesh.export(out.with_suffix(".ply"))
    path = out.with_suffix(".json")
    path.write_text(json.dumps(scene(out.with_suffix(".ply").name, seen_by, *size), indent=1), encoding="utf-8")
    return path


def write(name: str, folder: Path) -> Path:
    """The file of one of SCENES, in ``folder`` where it has to be made."""
    made = SCENES[name]
    return CORNELL if made is None else write_made(folder / name, made)


def main() -> None:
    parser = argparse.ArgumentParser(description="Write a benchmark scene.")
    parser.add_argument("out", type=Path)
    parser.add_argument("--faces", type=int, default=20480, help="of a sphere: 20, 80, 320, … 20480")
    parser.add_argument("--spheres", type=int, default=50)
    parser.add_argument("--beams", type=int, metavar="N", help="N beams in place of spheres")
    parser.add_argument("--size", type=int, nargs=2, default=(480, 270))
    arguments = parser.parse_args()
    made = Spheres(arguments.spheres, arguments.faces) if arguments.beams is None else Beams(arguments.beams)
    write_made(arguments.out, made, tuple(arguments.size))


if __name__ == "__main__":
    main()
