"""LuxCore as a peer of the benchmark (tools/benchmark_peer.py): its path tracer on the CPU, no denoiser, no adaptive sampling.

A render is a session: what is timed begins when its threads do, with the accelerator built, and ends at the first look, every hundredth of a second, that
finds all samples taken; seconds are scaled to the samples that were asked for.
"""

from __future__ import annotations

import os
import time
from typing import Any

import numpy as np
from benchmark_peer import Told, serve

NEVER = 1 << 20
SECONDS_A_LOOK = 0.01


def start(told: Told) -> tuple[str, Any]:
    """Makes the scene."""
    import pyluxcore

    pyluxcore.Init(lambda line: None)
    width, height = told.size
    scene = pyluxcore.Scene()
    for properties in (_camera(told), _sky(told.values["sky"]), *_meshes(told)):
        scene.Parse(_properties(pyluxcore, properties))

    def render(seed: int, spp: int) -> tuple[float, np.ndarray]:
        session = pyluxcore.RenderSession(pyluxcore.RenderConfig(_properties(pyluxcore, _settings(told, seed)), scene))
        wanted = spp * width * height
        session.Start()
        begin = time.perf_counter()
        taken = 0.0
        while taken < wanted:
            time.sleep(SECONDS_A_LOOK)
            session.UpdateStats()
            taken = session.GetStats().Get("stats.renderengine.total.samplecount").GetFloat()
        seconds = (time.perf_counter() - begin) * wanted / taken
        session.Stop()
        pixels = np.zeros(3 * width * height, np.float32)
        session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0)
        return seconds, pixels.reshape(height, width, 3)[::-1]  # rows from below

    return f"LuxCore {pyluxcore.Version()}", render


def _properties(pyluxcore: Any, values: dict[str, Any]) -> Any:
    properties = pyluxcore.Properties()
    for name, value in values.items():
        properties.Set(pyluxcore.Property(name, value))
    return properties


def _settings(told: Told, seed: int) -> dict[str, Any]:
    width, height = told.size
    depth = told.values["max_depth"]
    return {
        "renderengine.type": "PATHCPU", "renderengine.seed": seed + 1, "sampler.type": "SOBOL", "sampler.sobol.adaptive.strength": 0.0,
        "native.threads.count": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "film.width": width, "film.height": height, "film.filter.type": "NONE", "film.outputs.0.type": "RGB", "film.outputs.0.filename": "out.exr",
        "path.pathdepth.total": depth + 1, "path.pathdepth.diffuse": depth + 1, "path.pathdepth.glossy": depth + 1, "path.pathdepth.specular": depth + 1,
        "path.russianroulette.depth": told.values["roulette_depth"] or NEVER, "path.clamping.variance.maxvalue": 0.0,
        "path.hybridbackward.enable": False, "lightstrategy.type": "POWER"}


def _camera(told: Told) -> dict[str, Any]:
    to_world = np.array(told.values["to_world"])
    position, up, back = to_world[:3, 3], to_world[:3, 1], to_world[:3, 2]
    half_x, half_y = told.values["half_extent"]
    pixel = 2.0 * half_y / told.size[1]  # by which LuxCore's picture stands lower than the others'
    return {"scene.camera.type": "perspective", "scene.camera.lookat.orig": position.tolist(), "scene.camera.lookat.target": (position - back).tolist(),
            "scene.camera.up": up.tolist(), "scene.camera.fieldofview": 90.0, "scene.camera.screenwindow": [-half_x, half_x, -half_y - pixel, half_y - pixel],
            "scene.camera.cliphither": 1e-3, "scene.camera.clipyon": 1e4, "scene.camera.autovolume.enable": False}


def _sky(radiance: list[float] | None) -> dict[str, Any]:
    return {} if not radiance else {"scene.lights.sky.type": "constantinfinite", "scene.lights.sky.color": radiance}


def _meshes(told: Told) -> list[dict[str, Any]]:
    found = []
    for number, mesh in enumerate(told.meshes):
        material = f"scene.materials.m{number}"
        found.append({f"{material}.type": "matte", f"{material}.kd": mesh.albedo, **({f"{material}.emission": mesh.emission} if mesh.emission else {})})
        path = mesh.write_ply(told.folder / f"{number}.ply")
        found.append({f"scene.objects.o{number}.ply": str(path), f"scene.objects.o{number}.material": f"m{number}"})
    return found


if __name__ == "__main__":
    serve(start)
