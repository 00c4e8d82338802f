"""The checks: each renders something whose outcome is known, and says how far off it is in standard deviations or counts."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
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

SCENES = ("diffuse", "glass", "metal", "layers")

SPP = 1024
"""Of the pictures that are compared with stored ones."""


WHITE: dict[str, dict[str, Any]] = {
    "lambert": {"type": "lambert", "albedo": 1.0}, "oren_nayar": {"type": "oren_nayar", "albedo": 1.0, "roughness": 0.0},
    "mirror": {"type": "mirror"}, "dielectric": {"type": "dielectric", "ior": 1.5}, "thin_dielectric": {"type": "thin_dielectric", "ior": 1.5}}
"""Materials that absorb nothing."""


@dataclass(frozen=True)
class Finding:
    """``passed``, what was found and expected in words, and the record of the render."""

    passed: bool
    text: str
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


def furnace(material: dict[str, Any], device: Any) -> Finding:
    """A white surface in white surroundings of radiance 1 cannot be seen: every pixel is 1."""
    job = _job({"camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]}, "film": {"width": 16, "height": 16},
                "sampler": {"spp": 64, "type": "independent"}, "integrator": {"max_depth": 100},
                "geometry": [{"type": "sphere", "material": material}], "lights": [{"type": "environment", "radiance": 1}]}, device)
    job.run()
    image = job.image({})
    off = float(image.pixels.mean(dtype=np.float64)) - 1.0
    # Grey: the channels are one measurement. 1e-5 is for rounding along the paths, where there is no noise at all.
    deviation = float(np.sqrt(image.variance[..., 0].sum(dtype=np.float64))) / image.variance[..., 0].size
    passed = abs(off) <= quantile(len(WHITE)) * deviation + 1e-5 and image.record["non_finite"]["count"] == 0
    return Finding(passed, f"mean 1 {off:+.2e} ± {deviation:.1e}, expected 1", image.record)


def distribution(device: Any) -> Finding:
    """Directions that a diffuse floor scatters in are distributed as their cosine: χ² over 16 × 16 cells, read from the path state."""
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
    return Finding(abs(deviate) <= quantile(1), f"{deviate:+.2f} standard deviations from the mean χ², expected within {quantile(1):.1f}",
                   job.image({}).record)


def watertightness(device: Any) -> Finding:
    """Rays at the very vertices, edges and faces of a height field: no light may come through it.

    Its vertices and the pixels' centres are whole numbers over a power of two, so that rays meet them exactly, and others miss them by a rounding.
    """
    n, size = 33, 32
    at = np.arange(n + 1)
    x, y = (grid.ravel() for grid in np.meshgrid(at, at))
    heights = 0.3 * np.random.default_rng(5).random(len(x))
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.concatenate([np.stack([corner, corner + 1, corner + n + 2], 1), np.stack([corner, corner + n + 2, corner + n + 1], 1)])
    mesh = {"type": "mesh", "vertices": np.stack([x - n // 2, y - n // 2, heights], 1).tolist(), "faces": faces.tolist(),
            "material": {"type": "lambert", "albedo": 0.0}}
    leaks, rays = 0, 0
    record = None
    for shift in (0.5, 1.0):  # pixels' centres at the vertices; at the middles of the diagonals
        job = _job({"camera": {"type": "orthographic", "position": [shift, shift, 5], "look_at": [shift, shift, 0], "height": size},
                    "film": {"width": size, "height": size, "filter": {"type": "box", "radius": 1e-6}}, "sampler": {"spp": 64},
                    "geometry": [mesh], "lights": [{"type": "environment", "radiance": 1}], "integrator": {"max_depth": 0}}, device)
        job.run()
        image = job.image({})
        leaks += int(np.count_nonzero(image.pixels))
        rays += size**2 * 64
        record = image.record
    return Finding(leaks == 0, f"{leaks} values lit through a surface without holes in {rays} rays, expected 0", record)


def trees(device: Any) -> Finding:
    """What rays meet does not depend on who built the tree: the picture of a rough sphere is the same to the bit with numpy's as with the device's own."""
    n = 64
    rows, columns = (grid.ravel() for grid in np.mgrid[:n, :n])
    theta, phi = np.pi * (rows + 0.5) / n, 2.0 * np.pi * columns / n
    radius = 1.0 + 0.2 * np.random.default_rng(6).random(n * n)
    vertices = radius[:, None] * np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], 1)
    right, below = rows * n + (columns + 1) % n, np.minimum(rows + 1, n - 1) * n
    faces = np.concatenate([np.stack([rows * n + columns, right, below + columns], 1), np.stack([right, below + (columns + 1) % n, below + columns], 1)])
    scene = {"camera": {"position": [0, 1, 4], "look_at": [0, 0, 0], "fov": 40}, "film": {"width": 32, "height": 32}, "sampler": {"spp": 16},
             "integrator": {"max_depth": 4}, "lights": [{"type": "environment", "radiance": 1}],
             "geometry": [{"type": "mesh", "vertices": vertices.tolist(), "faces": faces.tolist(), "smooth": False}]}
    images = []
    for here in (False, True):
        job = _job(scene, device, Overrides(build_on_device=here))
        job.run()
        images.append(job.image({}))
    other = int(np.count_nonzero(images[0].pixels != images[1].pixels))
    return Finding(other == 0, f"{other} of {images[0].pixels.size} values differ between the device's tree of {len(faces)} triangles and numpy's, expected 0",
                   images[1].record)


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


def picture(name: str, device: Any) -> Finding:
    """A small picture against the stored one: the means of 8 × 8 pixels, z-tested with the variances of both."""
    mean, variance = stored(name)
    scene = scene_of(name)
    job = _job(replace(scene, sampler=replace(scene.sampler, spp=SPP, seed=1)), device)
    job.run()
    image = job.image({})
    difference = blocks(image.pixels.astype(np.float64) - mean)
    deviation = np.sqrt(blocks(image.variance.astype(np.float64) + variance) / 64.0)
    z = float(np.abs(difference / deviation).max())
    passed = z <= quantile(difference.size) and image.record["non_finite"]["count"] == 0
    return Finding(passed, f"largest of {difference.size} deviations {z:.2f}, expected within {quantile(difference.size):.1f}; "
                   f"mean {100.0 * (image.pixels.mean(dtype=np.float64) / mean.mean() - 1.0):+.2f} %", image.record)


CHECKS: dict[str, Callable[[Any], Finding]] = {
    **{f"furnace of {name}": partial(furnace, material) for name, material in WHITE.items()},
    "χ² of diffuse directions": distribution,
    "watertightness": watertightness,
    "trees": trees,
    **{f"picture '{name}'": partial(picture, name) for name in SCENES}}
