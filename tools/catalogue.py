"""Measures what materials cost: compile time, size of the kernels, and samples a second, by how much of the catalogue a scene uses.

    python tools/catalogue.py [--device D] [--size 256] [--spp 32]

The scenes are the same 24 spheres in the same room; what differs is how many kinds of material they share out. `new programs` are those
that ten more spheres with materials of their own, of the kinds that are there, make the renderer build. Compiling is that of the whole set of
programs, side by side, with every cache empty; renders take turns.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from benchmark_start import CACHES  # noqa: E402

ONE = [{"type": "lambert", "albedo": 0.6}]
FOUR = [*ONE, {"type": "conductor", "metal": "gold", "roughness": 0.3}, {"type": "dielectric"}, {"type": "plastic", "albedo": [0.1, 0.3, 0.6]}]
ALL = [*FOUR, {"type": "oren_nayar"}, {"type": "phong", "specular": 0.3, "albedo": 0.5, "exponent": 30}, {"type": "mirror", "reflectance": 0.9},
       {"type": "conductor", "metal": "copper"}, {"type": "dielectric", "roughness": 0.3}, {"type": "thin_dielectric"},
       {"type": "principled", "base_color": [0.5, 0.2, 0.1], "roughness": 0.4},
       {"type": "principled", "base_color": [0.2, 0.5, 0.1], "metallic": 0.5, "clearcoat": 1.0, "sheen": 0.5, "transmission": 0.5, "anisotropy": 0.5},
       {"type": "subsurface", "radius": 0.1}]
CATALOGUES = {"lambert only": ONE, "four kinds": FOUR, "the whole catalogue": ALL}

SPHERES, MORE = 24, 10


def scene(materials: list[dict[str, Any]], spheres: int) -> dict[str, Any]:
    """``spheres`` spheres in rows of six, each with a material of its own, of the kinds of ``materials`` in turn."""
    geometry = [{"type": "sphere", "radius": 0.45, "position": [number % 6 - 2.5, number // 6 - 1.5, 0.0],
                 "material": materials[number % len(materials)]} for number in range(spheres)]
    geometry += [{"type": "plane", "position": [0, 0, -1], "normal": [0, 0, 1]}, {"type": "plane", "position": [0, -2.2, 0], "normal": [0, 1, 0]}]
    return {"scene": {"camera": {"position": [0, 0, 9], "look_at": [0, 0, 0]}, "film": {"width": 256, "height": 256}, "geometry": geometry,
                      "lights": [{"type": "area", "shape": "rectangle", "radiance": 8, "transform": [{"scale": 2}, {"look_at": {
                          "origin": [2, 5, 5], "target": [0, 0, 0], "up": [0, 1, 0]}}]}]}}


def build_seconds(path: Path, device: str | None) -> float:
    """Wall-clock seconds of building all programs, with empty caches, in a process of its own."""
    with tempfile.TemporaryDirectory() as caches:
        environment = os.environ | dict.fromkeys(CACHES, caches)
        command = [sys.executable, __file__, "--build", str(path), *(("--device", device) if device else ())]
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    return float(done.stdout.split()[-1])


def prepare(path: Path, device: str | None, size: int, spp: int) -> Any:
    """A Render of the scene at ``path``."""
    from lumiere import api
    from lumiere.rendering import Render

    return Render(api.with_options(api.load(path), {"width": size, "height": size, "spp": spp}), device)


def binary_bytes(job: Any) -> int:
    """Bytes of the programs as the driver gives them."""
    import pyopencl as cl

    return sum(sum(build.program.get_info(cl.program_info.BINARY_SIZES)) for build in job.wavefront.builds)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--device")
    parser.add_argument("--size", type=int, default=256, help="pixels each way")
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--builds", type=int, default=3, help="with empty caches")
    parser.add_argument("--build", type=Path, metavar="SCENE", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.build:
        print(prepare(options.build, options.device, 16, 1).seconds["compile"])
        return
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update(dict.fromkeys(CACHES, folder))  # what is built anew shows as such
        paths = {}
        for name, materials in CATALOGUES.items():
            for spheres in (SPHERES, SPHERES + MORE):
                paths[name, spheres] = Path(folder) / f"{len(paths)}.json"
                paths[name, spheres].write_text(json.dumps(scene(materials, spheres)), encoding="utf-8")
        compiling = {name: median(build_seconds(paths[name, SPHERES], options.device) for _ in range(options.builds)) for name in CATALOGUES}
        jobs = {name: prepare(paths[name, SPHERES], options.device, options.size, options.spp) for name in CATALOGUES}
        known = {name: {build.name for build in job.wavefront.builds} for name, job in jobs.items()}
        more = {name: [build.name for build in prepare(paths[name, SPHERES + MORE], options.device, options.size, options.spp).wavefront.builds
                       if not build.reason.startswith("none")] for name in CATALOGUES}
    rates: dict[str, list[float]] = {name: [] for name in jobs}
    for turn in range(options.runs + 1):
        for name, job in jobs.items():
            job.restart(turn)
            begin = time.perf_counter()
            job.run()
            if turn:
                rates[name].append(job.samples / (time.perf_counter() - begin) / 1e6)
    print(f"{next(iter(jobs.values())).device.name}\n")
    print("| scene | programs | compile, s | source, kB | binaries, kB | bytes a path | Msamples/s | new programs |\n|---|---|---|---|---|---|---|---|")
    for name, job in jobs.items():
        source = sum(len(build.program.source) for build in job.wavefront.builds)
        print(f"| {name} | {len(known[name])} | {compiling[name]:.2f} | {source / 1e3:.0f} | {binary_bytes(job) / 1e3:.0f} | "
              f"{job.wavefront.bytes_per_path} | {median(rates[name]):.2f} | {len(more[name])} |")


if __name__ == "__main__":
    main()
