"""Mitsuba 3 as a peer of tools/benchmark.py: exports a scene for it, and renders that in a process of its own when told.

As a program (`python benchmark_mitsuba.py FOLDER`, started by Peer) it needs Mitsuba alone, and serves lines of standard input: an integer is a seed,
and is answered with the seconds that the render took and the mean of its pixels, which are then in FOLDER/picture.npy.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

LANES = {"llvm": 1 << 22, "cuda": 1 << 27}
"""Samples in one pass: Mitsuba holds them all in memory."""


def export(scene: Any, folder: Path, variant: str, sampler: str = "independent") -> None:
    """Writes ``scene`` (a lumiere Scene of Lambert triangles under constant lights, seen by a pinhole) for Mitsuba: FOLDER/scene.json and meshes.

    Raises ValueError for what has no counterpart here.
    """
    import numpy as np
    import trimesh

    film, camera, integrator = scene.film, scene.camera, scene.integrator
    half_x = camera.device_values(film.width, film.height)["half_extent"][0]
    never = 1 << 30
    out: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": integrator.max_depth + 1, "rr_depth": integrator.russian_roulette_depth or never},
        "sensor": {"type": "perspective", "fov": math.degrees(2.0 * math.atan(half_x)), "fov_axis": "x",
                   "to_world": (camera.to_world() @ np.diag([-1.0, 1.0, -1.0, 1.0])).tolist(),
                   "film": {"type": "hdrfilm", "width": film.width, "height": film.height, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
                   "sampler": {"type": sampler}}}
    shapes = list(scene.geometry)
    for number, light in enumerate(scene.lights):
        lowered = light.lower()
        if lowered is not None:
            shapes.append(lowered)
        elif light.type == "environment" and light.file is None:
            out[f"light {number}"] = {"type": "constant", "radiance": {"type": "rgb", "value": list(light.radiance)}}
        else:
            raise ValueError(f"found a light of type {light.type}, expected area lights and a constant environment")
    for number, shape in enumerate(shapes):
        for part, primitives in enumerate(shape.lower()):
            material = primitives.material or shape.material
            if primitives.device_shape.name != "triangle" or material.type != "lambert":
                raise ValueError(f"found {primitives.device_shape.name} of {material.type}, expected triangles of lambert")
            vertices = primitives.records["vertices"].reshape(-1, 3)
            mesh = folder / f"{number}-{part}.ply"
            trimesh.Trimesh(vertices, np.arange(len(vertices)).reshape(-1, 3), process=False).export(mesh)
            entry: dict[str, Any] = {"type": "ply", "filename": str(mesh), "face_normals": True, "bsdf": {"type": "twosided", "bsdf": {
                "type": "diffuse", "reflectance": {"type": "rgb", "value": list(material.albedo)}}}}
            emission = shape.emission if shape.emission is not None else material.emission
            if emission is not None and any(emission):
                entry["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": list(emission)}}
            out[f"shape {number} {part}"] = entry
    told = {"variant": variant, "spp": scene.sampler.spp, "pixels": film.width * film.height, "scene": out}
    (folder / "scene.json").write_text(json.dumps(told), encoding="utf-8")


class Peer:
    """A process that renders what ``export`` wrote. ``name`` is the renderer's, with its version."""

    def __init__(self, python: str, folder: Path) -> None:
        self.process = subprocess.Popen([python, __file__, str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.name = self._line()

    def _line(self) -> str:
        line = self.process.stdout.readline().strip()
        if not line:
            raise RuntimeError(f"Mitsuba ended with status {self.process.wait()}; what it said stands above")
        return line

    def render(self, seed: int) -> tuple[float, float]:
        """Seconds of a render, and the mean of its pixels; they are in the folder's picture.npy."""
        self.process.stdin.write(f"{seed}\n")
        self.process.stdin.flush()
        seconds, mean = self._line().split()
        return float(seconds), float(mean)

    def close(self) -> None:
        """Ends the process."""
        self.process.stdin.close()
        self.process.wait()


def serve(folder: Path) -> None:
    """Loads the scene in ``folder`` and answers standard input."""
    import mitsuba as mi

    told = json.loads((folder / "scene.json").read_text(encoding="utf-8"))
    mi.set_variant(told["variant"])
    import drjit as dr
    import numpy

    told["scene"]["sensor"]["to_world"] = mi.ScalarTransform4f(told["scene"]["sensor"]["to_world"])
    scene = mi.load_dict(told["scene"])
    a_pass = max(1, min(told["spp"], LANES[told["variant"].partition("_")[0]] // told["pixels"]))
    passes = [a_pass] * (told["spp"] // a_pass) + ([told["spp"] % a_pass] if told["spp"] % a_pass else [])
    print(f"Mitsuba {mi.__version__} {told['variant']}", flush=True)
    for line in sys.stdin:
        begin = time.perf_counter()
        total = 0.0
        for number, spp in enumerate(passes):
            picture = mi.render(scene, spp=spp, seed=1000 * int(line) + number)
            dr.eval(picture)
            dr.sync_thread()
            total = total + picture * (spp / told["spp"])
        dr.eval(total)
        dr.sync_thread()
        seconds = time.perf_counter() - begin
        numpy.save(folder / "picture.npy", numpy.array(total))
        print(seconds, dr.mean(total.array)[0], flush=True)


if __name__ == "__main__":
    serve(Path(sys.argv[1]))
