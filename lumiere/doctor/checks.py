"""The checks: each renders something whose outcome is known, and says how far off it is in standard deviations or counts."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib import resources
from typing import Any

import numpy as np

from lumiere.overrides import Overrides
from lumiere.rendering import Render
from lumiere.scene.load import load
from lumiere.scene.model import Scene
from lumiere.wavefront.batch import Batch
from lumiere.wavefront.state import path_fields

SIGNIFICANCE = 1e-6
"""A sound device fails a check by chance this often."""

SCENES = ("diffuse", "glass", "metal")


@dataclass(frozen=True)
class Check:
    """``passed``, and what was found and expected."""

    name: str
    passed: bool
    text: str
    seconds: float
    record: dict[str, Any] | None = None


def quantile(tests: int) -> float:
    """|z| that the largest of ``tests`` normal numbers exceeds with probability SIGNIFICANCE, by bisection."""
    low, high = 0.0, 40.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if math.erfc(middle / 2**0.5) > SIGNIFICANCE / tests else (low, middle)
    return high


def chi_square_z(counts: np.ndarray, expected: np.ndarray) -> float:
    """χ² of counts as a normal deviate (Wilson & Hilferty 1931)."""
    degrees = len(counts) - 1
    statistic = float(np.sum((counts - expected) ** 2 / expected))
    return ((statistic / degrees) ** (1.0 / 3.0) - (1.0 - 2.0 / (9.0 * degrees))) / (2.0 / (9.0 * degrees)) ** 0.5


def _job(scene: dict[str, Any] | Scene, device: Any, overrides: Overrides | None = None) -> Render:
    return Render(scene if isinstance(scene, Scene) else load({"scene": scene}), device, overrides=overrides)


def furnaces(device: Any) -> Iterator[Check]:
    """White surfaces in white surroundings of radiance 1 cannot be seen: every pixel is 1."""
    materials = {"lambert": {"type": "lambert", "albedo": 1.0}, "oren_nayar": {"type": "oren_nayar", "albedo": 1.0, "roughness": 0.0},
                 "mirror": {"type": "mirror"}, "dielectric": {"type": "dielectric", "ior": 1.5},
                 "thin_dielectric": {"type": "thin_dielectric", "ior": 1.5}}
    for name, material in materials.items():
        begin = time.perf_counter()
        job = _job({"camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]}, "film": {"width": 16, "height": 16},
                    "sampler": {"spp": 64, "type": "independent"}, "integrator": {"max_depth": 100},
                    "geometry": [{"type": "sphere", "material": material}], "lights": [{"type": "environment", "radiance": 1}]}, device)
        job.run()
        image = job.image({})
        off = float(image.pixels.mean(dtype=np.float64)) - 1.0
        # Grey: the channels are one measurement. 1e-5 is for rounding along the paths, where there is no noise at all.
        deviation = float(np.sqrt(image.variance[..., 0].sum(dtype=np.float64))) / image.variance[..., 0].size
        passed = abs(off) <= quantile(len(materials)) * deviation + 1e-5 and image.record["non_finite"]["count"] == 0
        yield Check(f"furnace of {name}", passed, f"mean 1 {off:+.2e} ± {deviation:.1e}, expected 1", time.perf_counter() - begin, image.record)


def distribution(device: Any) -> Iterator[Check]:
    """Directions that a diffuse floor scatters in are distributed as their cosine: χ² over 16 × 16 cells, read from the path state."""
    begin = time.perf_counter()
    samples = 1 << 15
    scene = load({"scene": {
        "camera": {"type": "orthographic", "position": [0, 1, 0], "look_at": [0, 0, 0], "up": [0, 0, 1], "height": 1},
        "film": {"width": 1, "height": 1}, "sampler": {"type": "independent", "spp": samples}, "integrator": {"max_depth": 2},
        "geometry": [{"type": "plane"}], "lights": [{"type": "environment", "radiance": 1}]}})
    job = Render(scene, device, overrides=Overrides(slots=samples, compacted=False))
    caught: list[np.ndarray] = []

    def observe(stage: str, launch: int, event: Any) -> None:
        if stage.startswith("shade") and not caught:
            event.wait()
            caught.append(job.wavefront.snapshot()[0])

    job.wavefront.observer = observe
    job.take(Batch(0, 1, samples, 0))
    job.wavefront.finish()
    first = 0
    for item in path_fields(job.wavefront.buffers.features):
        if item.name == "direction":
            break
        first += item.size if item.kind != "uint" else 0
    x, y, z = caught[0][first:first + 3, :samples].astype(np.float64)
    cells = 16
    row = np.minimum((np.clip(y, 0.0, 1.0) ** 2 * cells).astype(int), cells - 1)  # cos² is uniform
    column = np.minimum(((np.arctan2(z, x) / (2.0 * np.pi) + 0.5) * cells).astype(int), cells - 1)
    counts = np.bincount(row * cells + column, minlength=cells**2)
    deviate = chi_square_z(counts, np.full(cells**2, samples / cells**2))
    yield Check("χ² of diffuse directions", abs(deviate) <= quantile(1), f"{deviate:+.2f} standard deviations from the mean χ², expected within "
                f"{quantile(1):.1f}", time.perf_counter() - begin)


def watertightness(device: Any) -> Iterator[Check]:
    """Rays at the very vertices, edges and faces of a closed surface: no light may come through it."""
    n = 32
    at = np.arange(n + 1)
    x, y = (grid.ravel() for grid in np.meshgrid(at, at))
    heights = 0.3 * np.random.default_rng(5).random(len(x))
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.concatenate([np.stack([corner, corner + 1, corner + n + 2], 1), np.stack([corner, corner + n + 2, corner + n + 1], 1)])
    mesh = {"type": "mesh", "vertices": np.stack([x - n / 2, y - n / 2, heights], 1).tolist(), "faces": faces.tolist(),
            "material": {"type": "lambert", "albedo": 0.0}}
    leaks, rays, begin = 0, 0, time.perf_counter()
    record = None
    for offset in (0.0, 0.5):  # pixel centres at the vertices; at the middles of the diagonals
        size = n - 1
        # Across an even number of cells the pixels' centres are half a cell from the vertices, so the camera steps aside by as much.
        shift = 0.5 * ((size + 1) % 2) + offset
        job = _job({"camera": {"type": "orthographic", "position": [shift, shift, 5], "look_at": [shift, shift, 0], "height": size},
                    "film": {"width": size, "height": size, "filter": {"type": "box", "radius": 1e-6}}, "sampler": {"spp": 64},
                    "geometry": [mesh], "lights": [{"type": "environment", "radiance": 1}], "integrator": {"max_depth": 0}}, device)
        job.run()
        image = job.image({})
        inside = image.pixels if offset == 0.0 else image.pixels[1:, :-1]  # half a cell further, the last row and column look past the mesh
        leaks += int(np.count_nonzero(inside))
        rays += inside.shape[0] * inside.shape[1] * 64
        record = image.record
    yield Check("watertightness", leaks == 0, f"{leaks} pixels lit through a closed surface in {rays} rays, expected 0", time.perf_counter() - begin,
                record)


def stored(name: str) -> tuple[np.ndarray, np.ndarray]:
    """(h, w, 3) float64 mean and variance of the mean of a stored picture."""
    with resources.files("lumiere.doctor").joinpath(f"data/{name}.npz").open("rb") as file, np.load(file) as arrays:
        return arrays["mean"].astype(np.float64), arrays["variance"].astype(np.float64)


def scene_of(name: str) -> Scene:
    """One of the doctor's scenes."""
    with resources.as_file(resources.files("lumiere.doctor").joinpath(f"data/{name}.json")) as path:
        return load(path)


def blocks(values: np.ndarray, size: int = 8) -> np.ndarray:
    """Means over squares of ``size`` pixels."""
    h, w, c = values.shape
    return values.reshape(h // size, size, w // size, size, c).mean(axis=(1, 3))


def pictures(device: Any) -> Iterator[Check]:
    """Small pictures against stored ones: the means of 8 × 8 pixels, z-tested with the variances of both."""
    for name in SCENES:
        begin = time.perf_counter()
        mean, variance = stored(name)
        scene = scene_of(name)
        job = _job(replace(scene, sampler=replace(scene.sampler, seed=1)), device)
        job.run()
        image = job.image({})
        difference = blocks(image.pixels.astype(np.float64) - mean)
        deviation = np.sqrt(blocks(image.variance.astype(np.float64) + variance) / 64.0)
        z = float(np.abs(difference / deviation).max())
        passed = z <= quantile(difference.size) and image.record["non_finite"]["count"] == 0
        yield Check(f"picture '{name}'", passed, f"largest of {difference.size} deviations {z:.2f}, expected within {quantile(difference.size):.1f}; "
                    f"mean {100.0 * (image.pixels.mean(dtype=np.float64) / mean.mean() - 1.0):+.2f} %", time.perf_counter() - begin, image.record)


CHECKS: tuple[Callable[[Any], Iterator[Check]], ...] = (furnaces, distribution, watertightness, pictures)
