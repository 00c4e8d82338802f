"""Mitsuba 3 as a peer of the benchmark (tools/benchmark_peer.py). Options: its variant, and its sampler."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
from benchmark_peer import Told, serve

LANES = {"llvm": 1 << 22, "cuda": 1 << 27}
"""Samples in one pass: Mitsuba holds them all in memory."""

NEVER = 1 << 30


def start(told: Told) -> tuple[str, Any]:
    """Loads the scene."""
    import mitsuba as mi

    values = told.values
    variant = values["variant"]
    mi.set_variant(variant)
    import drjit as dr

    width, height = told.size
    to_world = np.array(values["to_world"]) @ np.diag([-1.0, 1.0, -1.0, 1.0])
    scene: dict[str, Any] = {
        "type": "scene", "integrator": {"type": "path", "max_depth": values["max_depth"] + 1, "rr_depth": values["roulette_depth"] or NEVER},
        "sensor": {"type": "perspective", "fov": math.degrees(told.view_angle), "fov_axis": "x",
                   "to_world": mi.ScalarTransform4f(to_world.tolist()), "sampler": {"type": values.get("sampler", "independent")},
                   "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb"}}}
    if values["sky"]:
        scene["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": values["sky"]}}
    for number, mesh in enumerate(told.meshes):
        entry: dict[str, Any] = {"type": "ply", "filename": str(mesh.write_ply(told.folder / f"{number}.ply")), "face_normals": True, "bsdf": {
            "type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": mesh.albedo}}}}
        if mesh.emission:
            entry["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": mesh.emission}}
        scene[f"mesh {number}"] = entry
    loaded = mi.load_dict(scene)
    most = max(1, LANES[variant.partition("_")[0]] // (width * height))

    def render(seed: int, spp: int) -> tuple[float, np.ndarray]:
        passes = [most] * (spp // most) + ([spp % most] if spp % most else [])
        begin = time.perf_counter()
        total = 0.0
        for number, some in enumerate(passes):
            picture = mi.render(loaded, spp=some, seed=1000 * seed + number)
            dr.eval(picture)
            dr.sync_thread()
            total = total + picture * (some / spp)
        dr.eval(total)
        dr.sync_thread()
        return time.perf_counter() - begin, np.array(total)

    return f"Mitsuba {mi.__version__} {variant}", render


if __name__ == "__main__":
    serve(start)
