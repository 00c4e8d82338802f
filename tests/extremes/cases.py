"""The extremes: what is rendered, what is expected, what came out. tools/extremes.py makes docs/extremes.md's table of them."""

from __future__ import annotations

import copy
import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from lumiere.rendering import Render
from lumiere.scene.load import load
from lumiere.scene.model import Scene
from lumiere.wavefront.batch import Batch

Json = dict[str, Any]


@dataclass(frozen=True)
class Outcome:
    """``passed``, and what came out, in words."""

    passed: bool
    text: str


@dataclass(frozen=True)
class Case:
    """``run(device, effort)`` renders it; ``effort`` 1 is quick, more means more samples. ``slow`` ones are left to tools/extremes.py."""

    name: str
    expected: str
    run: Callable[[Any, float], Outcome]
    slow: bool = False


def rendered(scene: Json | Scene, device: Any, **sampler: Any) -> tuple[np.ndarray, np.ndarray, dict[str, Any]]:
    """(h, w, 3) float64 picture and variance of its means, and the record."""
    loaded = scene if isinstance(scene, Scene) else load({"scene": scene})
    loaded = dataclasses.replace(loaded, sampler=dataclasses.replace(loaded.sampler, **sampler))
    job = Render(loaded, device)
    job.run()
    image = job.image({})
    return image.pixels.astype(np.float64), image.variance.astype(np.float64), image.record


def compared(a: tuple[np.ndarray, np.ndarray, Any], b: tuple[np.ndarray, np.ndarray, Any], factor: float = 1.0) -> Outcome:
    """Whether two pictures agree: means of 8 × 8 pixels, z-tested at 10⁻⁶ together; ``factor`` is what the second should be times."""
    def blocks(x: np.ndarray) -> np.ndarray:
        h, w, c = x.shape
        return x.reshape(h // 8, 8, w // 8, 8, c).mean(axis=(1, 3))

    difference = blocks(a[0] - factor * b[0])
    deviation = np.sqrt(blocks(a[1] + factor**2 * b[1]) / 64.0)
    z = np.abs(difference) / np.maximum(deviation, 1e-6 * np.abs(blocks(a[0])).mean() + 1e-300)
    bad = a[2]["non_finite"]["count"] + b[2]["non_finite"]["count"]
    return Outcome(bool(z.max() < 5.6 and bad == 0),
                   f"largest deviation {z.max():.2f}, mean {100.0 * (a[0].mean() / (factor * b[0].mean()) - 1.0):+.3f} %, {bad} not finite")


BASE: Json = {
    "camera": {"position": [0, 1.2, 4], "look_at": [0, 0.5, 0], "fov": 34}, "film": {"width": 24, "height": 24}, "integrator": {"max_depth": 4},
    "materials": {"grey": {"type": "lambert", "albedo": 0.6}, "gold": {"type": "conductor", "metal": "gold", "roughness": 0.4}},
    "geometry": [
        {"type": "rectangle", "material": "grey", "transform": [{"scale": 3.0}, {"rotate": {"axis": [1, 0, 0], "angle": -90}}]},
        {"type": "sphere", "material": "gold", "position": [-0.6, 0.5, 0], "radius": 0.5},
        {"type": "box", "material": "grey", "min": [0.3, 0, -0.4], "max": [0.9, 0.8, 0.2]},
        {"type": "disk", "material": "grey", "position": [0, 0.3, 0.9], "normal": [0, 1, 1], "radius": 0.25}],
    "lights": [{"type": "area", "position": [1, 3, 1], "normal": [-0.3, -1, -0.3], "radius": 0.4, "radiance": 10},
               {"type": "point", "position": [-2, 3, 1], "intensity": 5}]}
"""Every shape, an area light and a point light, lit by no environment: a picture that depends on the scene's placement alone."""


def placed(scale: float, offset: tuple[float, float, float]) -> Json:
    """BASE scaled and then moved. The point light's intensity grows with the area, so that the picture stays."""
    scene = copy.deepcopy(BASE)
    steps = [{"scale": scale}, {"translate": list(offset)}]
    for shape in scene["geometry"]:
        shape["transform"] = [*shape.get("transform", []), *steps]
    camera = scene["camera"]
    for name in ("position", "look_at"):
        camera[name] = [scale * x + o for x, o in zip(camera[name], offset, strict=True)]
    area, point = scene["lights"]
    area["transform"] = steps
    point["position"] = [scale * x + o for x, o in zip(point["position"], offset, strict=True)]
    point["intensity"] *= scale**2
    return scene


def placement(scale: float, offset: float) -> Callable[[Any, float], Outcome]:
    """BASE against BASE scaled, and moved by ``offset`` times its size."""
    def run(device: Any, effort: float) -> Outcome:
        away = (offset * scale, -0.7 * offset * scale, 0.3 * offset * scale)
        spp = int(64 * effort)
        return compared(rendered(placed(scale, away), device, spp=spp, seed=2), rendered(BASE, device, spp=spp, seed=1))

    return run


def furnace(material: Json, spp: int = 16, depth: int = 100, geometry: list[Json] | None = None) -> Callable[[Any, float], Outcome]:
    """A white object in white surroundings: 1 everywhere."""
    def run(device: Any, effort: float) -> Outcome:
        shapes = geometry or [{"type": "sphere"}]
        pixels, variance, record = rendered(
            {"camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]}, "film": {"width": 8, "height": 8},
             "integrator": {"max_depth": depth, "russian_roulette_depth": None},
             "geometry": [shape | {"material": material} for shape in shapes], "lights": [{"type": "environment", "radiance": 1}]},
            device, spp=int(spp * effort), type="independent")
        off, deviation = pixels.mean() - 1.0, math.sqrt(variance[..., 0].sum()) / 64.0
        bad = record["non_finite"]["count"]
        return Outcome(abs(off) < min(5.0 * deviation, 0.05) + 1e-4 and bad == 0, f"1 {off:+.1e} ± {deviation:.0e}, {bad} not finite")

    return run


def enclosure(device: Any, effort: float) -> Outcome:
    """A closed sphere of albedo 0.999 that emits 1 − 0.999 = 0.001: radiance 0.001 Σ 0.999^k over the depths."""
    depth = 1000
    pixels, variance, record = rendered(
        {"camera": {"type": "panorama"}, "film": {"width": 4, "height": 4}, "integrator": {"max_depth": depth, "russian_roulette_depth": None},
         "geometry": [{"type": "sphere", "emission": 0.001, "emission_sides": "both",
                       "material": {"type": "lambert", "albedo": 0.999, "two_sided": True}}]}, device, spp=int(8 * effort), type="independent")
    expected = 1.0 - 0.999 ** (depth + 1)
    off = pixels.mean() / expected - 1.0
    deviation = math.sqrt(variance[..., 0].sum()) / 16.0 / expected
    return Outcome(abs(off) < 5.0 * deviation + 1e-4 and record["non_finite"]["count"] == 0, f"{expected:.5f} {off:+.1e} ± {deviation:.0e}, relative")


def grazing(device: Any, effort: float) -> Outcome:
    """A camera just above an infinite plane that looks along it for 10⁶ units: below the horizon all is plane, above it all is sky."""
    pixels, _, record = rendered(
        {"camera": {"position": [0, 1, 0], "look_at": [0, 1, -1], "fov": 2e-4}, "film": {"width": 8, "height": 8}, "integrator": {"max_depth": 0},
         "geometry": [{"type": "plane", "emission": 3}], "lights": [{"type": "environment", "radiance": 1}]}, device, spp=4)
    # The picture spans 1.7e-6 radians each way: rows meet the plane from 5.7e5 units on.
    above, below = pixels[:4], pixels[4:]
    return Outcome(bool(np.all(above == 1.0) and np.all(below == 3.0)) and record["non_finite"]["count"] == 0,
                   f"{np.count_nonzero(above != 1.0)} of {above.size} values wrong above, {np.count_nonzero(below != 3.0)} below")


def slivers(device: Any, effort: float) -> Outcome:
    """A wall of 2,000 triangles of aspect 10⁶ in front of a light: no light through it."""
    count = 1000
    edges = np.linspace(-0.5, 0.5, count + 1) * 1e-3
    vertices = np.concatenate([np.stack([edges, np.full_like(edges, y), np.zeros_like(edges)], 1) for y in (-0.5, 0.5)])
    i = np.arange(count)
    faces = np.concatenate([np.stack([i, i + 1, i + count + 2], 1), np.stack([i, i + count + 2, i + count + 1], 1)])
    pixels, _, record = rendered(
        {"camera": {"type": "orthographic", "position": [0, 0, 1], "look_at": [0, 0, 0], "height": 9e-4}, "film": {"width": 32, "height": 32},
         "integrator": {"max_depth": 0}, "geometry": [{"type": "mesh", "vertices": vertices.tolist(), "faces": faces.tolist()}],
         "lights": [{"type": "environment", "radiance": 1}]}, device, spp=int(64 * effort))
    leaks = np.count_nonzero(pixels)
    return Outcome(leaks == 0 and record["non_finite"]["count"] == 0, f"{leaks} values lit in {int(65536 * effort)} rays")


def coincident(device: Any, effort: float) -> Outcome:
    """10⁴ triangles in one place look like one, and a tree can be built of them."""
    vertices = [[-1, -1, 0], [3, -1, 0], [-1, 3, 0]]

    def scene(faces: int) -> Json:
        return {"camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]}, "film": {"width": 8, "height": 8}, "integrator": {"max_depth": 1},
                "geometry": [{"type": "mesh", "vertices": vertices, "faces": [[0, 1, 2]] * faces}],
                "lights": [{"type": "point", "position": [0, 1, 3], "intensity": 10}]}

    return compared(rendered(scene(10000), device, spp=4), rendered(scene(1), device, spp=4))


def leaks(device: Any, effort: float) -> Outcome:
    """A closed mesh shot from inside at its vertices and edges, none gets out: 8 · 10⁵ rays, from effort 12 on 10⁷."""
    import trimesh

    sphere = trimesh.creation.icosphere(subdivisions=3)
    random = np.random.default_rng(9)
    matrix = np.eye(4)
    matrix[:3, :3] = np.linalg.qr(random.standard_normal((3, 3)))[0]
    vertices = np.asarray(sphere.vertices, dtype=np.float32).astype(np.float64)
    lit, rays, spp = 0, 0, int(512 * max(1.0, effort / 3.0))
    targets = np.concatenate([vertices[::16], 0.5 * (vertices[sphere.edges_unique[::48, 0]] + vertices[sphere.edges_unique[::48, 1]])])
    job = None
    for target in targets[:max(4, int(24 * effort))]:
        eye = 0.3 * random.standard_normal(3).clip(-1, 1)
        scene = load({"scene": {
            "camera": {"position": eye.tolist(), "look_at": target.tolist(), "up": [0.123, 0.456, 0.789], "fov": 1e-4},
            "film": {"width": 8, "height": 8}, "integrator": {"max_depth": 0}, "sampler": {"spp": spp},
            "geometry": [{"type": "mesh", "vertices": vertices.tolist(), "faces": sphere.faces.tolist(), "material": {"type": "lambert"}}],
            "lights": [{"type": "environment", "radiance": 1}]}})
        job = Render(scene, device)
        job.run()
        lit += int(np.count_nonzero(job.image({}).pixels))
        rays += 64 * spp
    return Outcome(lit == 0, f"{lit} values lit in {rays:,} rays")


def light_size(area: float, height: float) -> Callable[[Any, float], Outcome]:
    """A disk light of ``area`` at ``height`` over a white floor: irradiance by the closed form E = π L r² / (r² + h²), L such that the floor's is 0.2."""
    def run(device: Any, effort: float) -> Outcome:
        radius, expected = math.sqrt(area / math.pi), 0.2
        pixels, variance, record = rendered(
            {"camera": {"type": "orthographic", "position": [0, height / 2, 0], "look_at": [0, 0, 0], "up": [0, 0, -1],
                        "height": 1e-3 * min(radius, height)},
             "film": {"width": 4, "height": 4}, "integrator": {"max_depth": 1},
             "geometry": [{"type": "disk", "normal": [0, 1, 0], "radius": 5 * height, "material": {"type": "lambert", "albedo": 1.0}}],
             "lights": [{"type": "area", "position": [0, height, 0], "normal": [0, -1, 0], "radius": radius,
                         "radiance": expected * (radius**2 + height**2) / radius**2}]},
            device, spp=int(256 * effort))
        off, deviation = pixels.mean() / expected - 1.0, math.sqrt(variance[..., 0].sum()) / 16.0 / expected
        return Outcome(abs(off) < 5.0 * deviation + 1e-4 and record["non_finite"]["count"] == 0, f"{expected:.3f} {off:+.1e} ± {deviation:.0e}, relative")

    return run


def radiances(device: Any, effort: float) -> Outcome:
    """Emitters of 10⁻³⁰ and 10³⁰ side by side, each seen directly: exactly that."""
    pixels, _, record = rendered(
        {"camera": {"type": "orthographic", "position": [0, 0, 1], "look_at": [0, 0, 0], "height": 1.0}, "film": {"width": 4, "height": 4},
         "integrator": {"max_depth": 0}, "geometry": [
             {"type": "rectangle", "emission": 1e-30, "transform": [{"translate": [-1, 0, 0]}]},
             {"type": "rectangle", "emission": 1e30, "transform": [{"translate": [1, 0, 0]}]}]}, device, spp=16)
    dim, bright = pixels[:, 0] / 1e-30 - 1.0, pixels[:, 3] / 1e30 - 1.0
    worst = float(max(np.abs(dim).max(), np.abs(bright).max()))
    return Outcome(worst < 1e-5 and record["non_finite"]["count"] == 0, f"relative error at most {worst:.0e}, {record['non_finite']['count']} not finite")


def hot_pixel(device: Any, effort: float) -> Outcome:
    """An environment of one pixel at 10⁶ in blackness, over a white floor: the irradiance is the pixel's integral of L cos θ."""
    import tempfile
    from pathlib import Path

    import OpenImageIO

    width, height, row = 64, 32, 6
    picture = np.zeros((height, width, 3), np.float32)
    picture[row, 20] = 1e6
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hot.exr"
        out = OpenImageIO.ImageOutput.create("openexr")
        out.open(str(path), OpenImageIO.ImageSpec(width, height, 3, "float"))
        out.write_image(picture)
        out.close()
        pixels, variance, record = rendered(
            {"camera": {"position": [0, 1, 0], "look_at": [0, 0, 0], "up": [0, 0, -1]}, "film": {"width": 4, "height": 4},
             "integrator": {"max_depth": 1}, "geometry": [{"type": "plane", "material": {"type": "lambert", "albedo": 1.0}}],
             "lights": [{"type": "environment", "file": str(path)}]}, device, spp=int(1024 * effort))
    top, bottom = math.pi * row / height, math.pi * (row + 1) / height
    nearest = 1e6 * (2 * math.pi / width) * (math.sin(bottom) ** 2 - math.sin(top) ** 2) / 2.0 / math.pi
    off, deviation = pixels.mean() / nearest - 1.0, math.sqrt(variance[..., 0].sum()) / 16.0 / nearest
    # Between texels the radiance may be interpolated: then the same power is spread over four texels, at other cosines, off by up to 3 %.
    return Outcome(abs(off) < 0.03 + 5.0 * deviation and record["non_finite"]["count"] == 0, f"{nearest:.4g} {100 * off:+.2f} ± {100 * deviation:.2f} %")


def field_of_view(fov: float) -> Callable[[Any, float], Outcome]:
    """A disk that fills half of the picture's height, for any angle of view."""
    def run(device: Any, effort: float) -> Outcome:
        half = math.tan(math.radians(fov) / 2.0)
        pixels, _, record = rendered(
            {"camera": {"fov": fov}, "film": {"width": 64, "height": 64}, "integrator": {"max_depth": 0},
             "geometry": [{"type": "disk", "position": [0, 0, -1], "radius": half / 2.0, "emission": 1, "emission_sides": "both"}]}, device, spp=16)
        share, expected = pixels.mean(), math.pi / 16.0
        return Outcome(abs(share / expected - 1.0) < 3e-3 and record["non_finite"]["count"] == 0, f"covers {share:.5f} of the picture, π/16 = {expected:.5f}")

    return run


def summation(device: Any, effort: float) -> Outcome:
    """10⁶ × effort samples of a pixel, added on the device, against the same samples added in float64."""
    spp = int(1e6 * effort)
    scene = load({"scene": {
        "film": {"width": 1, "height": 1}, "sampler": {"spp": spp, "type": "independent"}, "integrator": {"max_depth": 0},
        "camera": {"type": "panorama"}, "geometry": [{"type": "rectangle", "emission": 1.1, "emission_sides": "both",
                                                      "transform": [{"translate": [0, 0, -0.1]}]}],
        "lights": [{"type": "environment", "radiance": 0.1}]}})
    job = Render(scene, device)
    exact, done = 0.0, 0
    step = min(job.wavefront.policy.batch, spp)
    while done < spp:
        count = min(step, spp - done)
        job.take(Batch(0, 1, count, done))
        job.wavefront.finish()
        exact += float(job.wavefront.sample_values()[0, :count].sum(dtype=np.float64))
        done += count
    device_sum = float(job.luminance_sums()[0])  # grey: luminance is the channel
    ulps = abs(device_sum / exact - 1.0) / 2.0**-23
    return Outcome(ulps < 1.0, f"relative difference {abs(device_sum / exact - 1.0):.1e} after {spp:,} samples (added plainly: up to {spp * 2**-24:.0e})")


def unseen(ior: float) -> Callable[[Any, float], Outcome]:
    """Smooth and rough balls that (almost) do not refract, before a wall of two halves: the picture without them."""
    def run(device: Any, effort: float) -> Outcome:
        balls = [{"type": "sphere", "position": [x, 0, 0], "radius": 0.7, "material": {"type": "dielectric", "ior": ior, "roughness": roughness}}
                 for x, roughness in ((-0.7, 0.0), (0.7, 0.3))]
        wall = [{"type": "rectangle", "emission": 6 + y, "emission_sides": "both", "transform": [{"scale": [20, 10, 1]}, {"translate": [0, y, -2]}]}
                for y in (-5, 5)]
        with_balls, without = (
            rendered({"camera": {"position": [0, 0.3, 4], "look_at": [0, 0, 0]}, "film": {"width": 16, "height": 16},
                      "geometry": geometry}, device, spp=int(64 * effort)) for geometry in (wall + balls, wall))
        return compared(with_balls, without)

    return run


def sheet_stack(ior: float, emission: Json) -> Json:
    """A view along the normal of 4,096 sheets that absorb nothing."""
    return {"camera": {"type": "orthographic", "position": [0, 0, 1], "look_at": [0, 0, 0], "height": 1}, "film": {"width": 8, "height": 8},
            "integrator": {"max_depth": 65535, "russian_roulette_depth": None},
            "geometry": [{"type": "rectangle", "transform": [{"scale": [50, 50, 1]}, {"translate": [0, 0, -0.001 * i]}],
                          "material": {"type": "thin_dielectric", "ior": ior}} for i in range(4096)], **emission}


def sheets(device: Any, effort: float) -> Outcome:
    """4,096 stacked sheets before a light: T / (T + N R), which follows from T + R = 1 of one (Stokes 1862). Of an index so low that few paths need
    more than 65,535 events."""
    ior, count = 1.05, 4096
    scene = sheet_stack(ior, {"lights": [{"type": "directional", "direction": [0, 0, 1], "irradiance": 1, "angle": 10}]})
    pixels, variance, record = rendered(scene, device, spp=int(64 * effort), type="independent")
    smooth = ((ior - 1.0) / (ior + 1.0)) ** 2
    reflected = 2.0 * smooth / (1.0 + smooth)
    expected = (1.0 - reflected) / (1.0 - reflected + count * reflected)
    light = 1.0 / (math.pi * math.sin(math.radians(5.0)) ** 2)
    off, deviation = pixels.mean() / light - expected, math.sqrt(variance[..., 0].sum()) / 64.0 / light
    return Outcome(abs(off) < 5.0 * deviation and record["non_finite"]["count"] == 0, f"{expected:.4f} {off:+.4f} ± {deviation:.4f}")


def many_events(device: Any, effort: float) -> Outcome:
    """As many sheets of glass in white surroundings: 1, less the paths that are still inside after 65,535 events."""
    pixels, _, record = rendered(sheet_stack(1.5, {"lights": [{"type": "environment", "radiance": 1}]}), device, spp=int(32 * effort), type="independent")
    return Outcome(0.97 < pixels.mean() < 1.0 + 1e-4 and record["non_finite"]["count"] == 0, f"{pixels.mean():.4f}")


CASES = [
    *(Case(f"scaled by {scale:.0e}", "the same picture", placement(scale, 0.0)) for scale in (1e-6, 1e-3, 1e3, 1e6)),
    *(Case(f"moved to {offset:.0e} × its size", "the same picture", placement(1.0, offset)) for offset in (1e3, 1e5, 1e7)),
    Case("grazing rays along a plane for 10⁶ units", "sky above, plane below", grazing),
    Case("slivers of aspect 10⁶", "no light through them", slivers),
    Case("10⁴ coincident triangles", "the picture of one", coincident),
    Case("closed mesh shot at vertices and edges", "no leak", leaks),
    Case("closed sphere of albedo 0.999 to depth 1000", "Σ 0.001 · 0.999ᵏ", enclosure),
    Case("roughness 10⁻⁶, conductor", "1", furnace({"type": "conductor", "metal": "none", "roughness": 1e-6})),
    Case("roughness 10⁻⁶, dielectric", "1", furnace({"type": "dielectric", "roughness": 1e-6})),
    Case("a light of 10⁻¹² m², a metre away", "E = π L r² / (r² + h²)", light_size(1e-12, 1.0)),
    Case("a light of 10⁻¹² m², its diameter away", "E = π L r² / (r² + h²)", light_size(1e-12, 2e-6 / math.sqrt(math.pi))),
    Case("a light of 10¹² m², a metre away", "E = π L r² / (r² + h²)", light_size(1e12, 1.0)),
    Case("a light of 10¹² m², its diameter away", "E = π L r² / (r² + h²)", light_size(1e12, 2e6 / math.sqrt(math.pi))),
    Case("radiance 10⁻³⁰ beside 10³⁰", "both as they are", radiances),
    Case("an environment with one pixel at 10⁶", "its irradiance", hot_pixel),
    Case("field of view 10⁻³°", "a disk covers π/16", field_of_view(1e-3)),
    Case("field of view 179°", "a disk covers π/16", field_of_view(179.0)),
    Case("10⁶ samples summed", "the sum in float64", summation),
    Case("ior 1", "1", furnace({"type": "dielectric", "ior": 1.0})),
    Case("ior 1 + 10⁻⁷", "1", furnace({"type": "dielectric", "ior": 1.0000001})),
    Case("ior 1, before a wall", "the wall", unseen(1.0)),
    Case("ior 1 + 10⁻⁷, before a wall", "the wall", unseen(1.0000001)),
    Case("4,096 stacked dielectric sheets", "T / (T + N R)", sheets),
    Case("4,096 sheets of glass, white surroundings", "1 less what max_depth cuts off", many_events, slow=True),
]
