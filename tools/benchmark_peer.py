"""Peers of the benchmark: a process of its own that says its name, and then answers each line of its standard input with a line.

Renderers (RENDERERS, one file each) get a scene that `export` writes and serve seeds by `serve`. They may run in another interpreter, so this file needs
numpy alone.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Renderer:
    """``file`` serves it, in an interpreter that can import ``module``, which `pip install PACKAGE` brings; ``gpu``: also on one."""

    name: str
    module: str
    package: str
    file: str
    gpu: bool


RENDERERS = (
    Renderer("Mitsuba", "mitsuba", "mitsuba", "benchmark_mitsuba.py", gpu=True),
    Renderer("Cycles", "bpy", "bpy", "benchmark_cycles.py", gpu=False),
    Renderer("LuxCore", "pyluxcore", "pyluxcore", "benchmark_luxcore.py", gpu=False),
)


class Peer:
    """A process that serves. ``name`` is the peer's, with its version: the first line that it wrote."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str] | None = None) -> None:
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)
        self.command = " ".join(command)
        self.name = self._line()

    def _line(self) -> str:
        line = self.process.stdout.readline().strip()
        if not line:
            raise RuntimeError(f"the peer `{self.command}` ended with status {self.process.wait()}; what it said stands above")
        return line

    def ask(self, request: str) -> list[str]:
        """The words of the answer to the line ``request``. Raises RuntimeError where the peer is gone."""
        self.process.stdin.write(f"{request}\n")
        self.process.stdin.flush()
        return self._line().split()

    def close(self) -> None:
        """Ends the process."""
        self.process.stdin.close()
        self.process.wait()


class RendererPeer(Peer):
    """A renderer on what `export` wrote to ``folder``."""

    def __init__(self, renderer: Renderer, python: str, folder: Path) -> None:
        empty = folder / "no OpenCL"  # LuxCore looks at every OpenCL device and some kill it; no peer needs one
        empty.mkdir(exist_ok=True)
        super().__init__([python, str(HERE / renderer.file), str(folder)], os.environ | {"OCL_ICD_VENDORS": str(empty)})
        self.written = (folder / renderer.file).with_suffix(".npy")

    def render(self, seed: int, spp: int) -> float:
        """Seconds of ``spp`` samples a pixel; the picture is then to be had from ``picture``."""
        return float(self.ask(f"{seed} {spp}")[0])

    def picture(self) -> np.ndarray:
        """(height, width, 3) float32: the last one rendered."""
        return np.load(self.written)


def interpreter(renderer: Renderer, pythons: Sequence[str]) -> str | None:
    """The first of ``pythons`` that has the renderer."""
    code = f"import importlib.util, sys; sys.exit(importlib.util.find_spec({renderer.module!r}) is None)"
    return next((python for python in pythons if subprocess.run([python, "-c", code], capture_output=True, check=False).returncode == 0), None)


def export(scene: Any, folder: Path, **options: Any) -> None:
    """Writes ``scene`` (a lumiere Scene of Lambert triangles under constant lights, seen by a pinhole) as FOLDER/scene.json and a FOLDER/*.npz a mesh.

    ``options`` are handed on. Raises ValueError for what has no counterpart in all peers.
    """
    film, camera, integrator = scene.film, scene.camera, scene.integrator
    folder.mkdir(exist_ok=True)
    out: dict[str, Any] = {
        "width": film.width, "height": film.height, "max_depth": integrator.max_depth, "roulette_depth": integrator.russian_roulette_depth,
        "half_extent": list(camera.device_values(film.width, film.height)["half_extent"]), "to_world": camera.to_world().tolist(),
        "sky": None, "meshes": [], **options}
    shapes = list(scene.geometry)
    for light in scene.lights:
        lowered = light.lower()
        if lowered is not None:
            shapes.append(lowered)
        elif light.type == "environment" and light.file is None:
            out["sky"] = list(light.radiance)
        else:
            raise ValueError(f"found a light of type {light.type}, expected area lights and a constant environment")
    for shape in shapes:
        for primitives in shape.lower():
            material = primitives.material or shape.material
            if primitives.device_shape.name != "triangle" or material.type != "lambert":
                raise ValueError(f"found {primitives.device_shape.name} of {material.type}, expected triangles of lambert")
            name = f"{len(out['meshes'])}.npz"
            vertices, faces = _welded(primitives.records["vertices"].reshape(-1, 3))
            np.savez(folder / name, vertices=vertices, faces=faces)
            emission = shape.emission if shape.emission is not None else material.emission
            out["meshes"].append({"file": name, "albedo": list(material.albedo), "emission": list(emission) if emission and any(emission) else None})
    (folder / "scene.json").write_text(json.dumps(out), encoding="utf-8")


def _welded(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (m, 3) float32, each once, and faces (n, 3) int32, of corners (3n, 3)."""
    corners = np.ascontiguousarray(corners, np.float32) + np.float32(0.0)  # no −0
    _, first, index = np.unique(corners.view("V12").ravel(), return_index=True, return_inverse=True)
    return corners[first], index.reshape(-1, 3).astype(np.int32)


@dataclass(frozen=True)
class Mesh:
    """``vertices`` (m, 3) float32 and ``faces`` (n, 3) int32 of one material; ``emission`` is None or a radiance, on the front alone."""

    vertices: np.ndarray
    faces: np.ndarray
    albedo: list[float]
    emission: list[float] | None

    def write_ply(self, path: Path) -> Path:
        """Writes binary PLY."""
        header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(self.vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
                  f"element face {len(self.faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        records = np.zeros(len(self.faces), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
        records["count"], records["corners"] = 3, self.faces
        path.write_bytes(header.encode() + self.vertices.astype("<f4").tobytes() + records.tobytes())
        return path


@dataclass(frozen=True)
class Told:
    """What `export` wrote: values as they stand in the file, and the meshes."""

    folder: Path
    values: dict[str, Any]
    meshes: list[Mesh]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.values["width"], self.values["height"]

    @property
    def view_angle(self) -> float:
        """Full angle of view along the picture's x, radians."""
        return 2.0 * math.atan(self.values["half_extent"][0])


def read(folder: Path) -> Told:
    """Reads what `export` wrote."""
    values = json.loads((folder / "scene.json").read_text(encoding="utf-8"))
    meshes = []
    for mesh in values["meshes"]:
        arrays = np.load(folder / mesh["file"])
        meshes.append(Mesh(arrays["vertices"], arrays["faces"], mesh["albedo"], mesh["emission"]))
    return Told(folder, values, meshes)


def serve(start: Callable[[Told], tuple[str, Callable[[int, int], tuple[float, np.ndarray]]]]) -> None:
    """A renderer's program: reads the folder that the command line names, and answers standard input.

    ``start`` gives the renderer's name and a function of seed and spp that gives the seconds taken and the picture, (height, width, 3). What the
    renderer writes to standard output goes nowhere.
    """
    answers = os.fdopen(os.dup(1), "w")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    told = read(Path(sys.argv[1]))
    name, render = start(told)
    print(name, file=answers, flush=True)
    for line in sys.stdin:
        seed, spp = (int(word) for word in line.split())
        seconds, picture = render(seed, spp)
        np.save((told.folder / Path(sys.argv[0]).name).with_suffix(".npy"), np.asarray(picture, np.float32))
        print(seconds, file=answers, flush=True)
