"""A path in words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from lumiere.compile.scene import lower
from lumiere.rendering import Render
from lumiere.scene.model import Scene
from lumiere.trace.watch import Path, Vertex, watch


def trace_path(scene: Scene, pixel: tuple[int, int], sample: int, device: str | int | None) -> Iterator[str]:
    """Lines that tell what ``sample`` of ``pixel`` did at each vertex.

    MIS weights come from replaying the path with light sampling alone and with BSDF sampling alone: the random numbers are the same, so the
    vertices are, and what each adds is what MIS weighs.
    """
    path, job = watch(scene, pixel, sample, device)
    modes = {}
    if scene.integrator.light_sampling == "mis":
        for mode in ("light", "bsdf"):
            changed = replace(scene, integrator=replace(scene.integrator, light_sampling=mode))
            modes[mode] = watch(changed, pixel, sample, device)[0]
    yield f"pixel {pixel[0]} {pixel[1]}, sample {sample}, seed {scene.sampler.seed}, on {job.device.name.strip()}"
    describe = _Describer(scene, job)
    for number, vertex in enumerate(path.vertices):
        yield from describe.vertex(number, vertex, path, modes)
    yield f"radiance {_vector(path.radiance)}" + ("" if np.all(np.isfinite(path.radiance)) else "  NOT FINITE: counts as 0 in the picture")


def _vector(v: Any) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in v) + ")"


class _Describer:
    """Knows what the primitives of a compiled scene are."""

    def __init__(self, scene: Scene, job: Render) -> None:
        self.arrays = {name: np.asarray(array) for name, (_, array) in job.wavefront.buffers.arrays.items()}
        self.render = self.arrays["render"]
        self.center = job.wavefront.buffers.origin
        self.shapes = list(job.wavefront.buffers.features.shapes)
        self.objects = lower(scene)[0]

    def vertex(self, number: int, vertex: Vertex, path: Path, modes: dict[str, Path]) -> Iterator[str]:
        """The lines of a vertex."""
        yield f"vertex {number}: ray from {_vector(vertex.origin + self.center)} along {_vector(vertex.direction)}, throughput {_vector(vertex.throughput)}" + (
            f", BSDF pdf {vertex.bsdf_pdf:.6g}" if vertex.bsdf_pdf else "")
        if vertex.primitive is None:
            if vertex.program == "escape":
                yield f"  leaves the scene: adds {_vector(vertex.emitted)}{self._weight(number, vertex, modes)}"
            elif vertex.program == "scatter":
                yield (f"  scatters in the body after {vertex.t:.6g} at {_vector(vertex.origin + vertex.t * vertex.direction + self.center)}"
                       + ("" if vertex.goes_on else ": the path ends"))
            else:
                yield "  meets nothing"
            return
        yield f"  meets {self._thing(vertex)}"
        if np.any(vertex.emitted):
            yield f"  emits: adds {_vector(vertex.emitted)}{self._weight(number, vertex, modes)}"
        if vertex.offered is not None:
            blocked = not np.any(vertex.connected)
            yield (f"  shadow ray along {_vector(vertex.shadow_direction)}: {'blocked, would add' if blocked else 'adds'} {_vector(vertex.offered)}"
                   f"{self._light_weight(number, vertex, modes)}")
        if not vertex.goes_on:
            yield "  the path ends"

    def _thing(self, vertex: Vertex) -> str:
        index = int(self.arrays["primitive_objects"][vertex.primitive])
        item = self.objects[index]
        shape = next((name for name in self.shapes
                      if 0 <= vertex.primitive - int(self.render[f"{name}_first"][0]) < int(self.render[f"{name}_count"][0])), "?")
        within = vertex.primitive - int(self.render[f"{shape}_first"][0])
        point, normal = self._point_and_normal(shape, within, vertex)
        name = f" '{item.shape.name}'" if item.shape.name else ""
        material = f" '{item.material.name}'" if item.material.name else ""
        facing = "" if normal is None else f", n {_vector(normal)} ({'front' if normal @ vertex.direction < 0.0 else 'back'} side)"
        return (f"object {index}{name} ({item.shape.type}), {shape} {within} (primitive {vertex.primitive}), t {vertex.t:.6g}, "
                f"u {vertex.uv[0]:.6g}, v {vertex.uv[1]:.6g}; material{material} ({item.material.type}), {vertex.program or 'not shaded'}; "
                f"p {_vector(point + self.center)}{facing}")

    def _point_and_normal(self, shape: str, index: int, vertex: Vertex) -> tuple[np.ndarray, np.ndarray | None]:
        """Of the geometry, in double precision; the normal is None for a shape that is not known here."""
        point = vertex.origin + vertex.t * vertex.direction
        if shape == "triangle":
            a, b, c = self.arrays["triangle_vertices"].reshape(-1, 3, 3)[index].astype(np.float64)
            u, v = vertex.uv
            normal = np.cross(b - a, c - a)
            return (1.0 - u - v) * a + u * b + v * c, normal / max(np.linalg.norm(normal), np.finfo(float).tiny)
        record = self.arrays[f"{shape}s"][index]
        if shape == "sphere":
            normal = point - record["center"]
        elif shape == "disk":
            normal = np.cross(record["axis_u"].astype(np.float64), record["axis_v"])
        elif shape == "plane":
            normal = record["normal"].astype(np.float64)
        else:
            return point, None
        return point, normal / max(np.linalg.norm(normal), np.finfo(float).tiny)

    def _weight(self, number: int, vertex: Vertex, modes: dict[str, Path]) -> str:
        """MIS weight of emission that the path met, and the density with which light sampling would have chosen that direction."""
        if not modes or not vertex.bsdf_pdf or number >= len(modes["bsdf"].vertices):
            return ""
        weight = _ratio(vertex.emitted, modes["bsdf"].vertices[number].emitted)
        if weight is None:
            return ""
        light_pdf = vertex.bsdf_pdf * (1.0 / weight - 1.0) ** 0.5 if 0.0 < weight <= 1.0 else float("nan")
        return f", MIS weight {weight:.6g} (BSDF pdf {vertex.bsdf_pdf:.6g}, light pdf {light_pdf:.4g})"

    def _light_weight(self, number: int, vertex: Vertex, modes: dict[str, Path]) -> str:
        """MIS weight of a sampled light, and both densities of its direction; that of light sampling includes the choice of the light."""
        pdfs = f"light pdf {vertex.light_pdf:.6g}, BSDF pdf {vertex.light_bsdf_pdf:.6g}"
        other = modes["light"].vertices[number] if modes and number < len(modes["light"].vertices) else None
        weight = None if other is None or other.offered is None else _ratio(vertex.offered, other.offered)
        return f", {pdfs}" if weight is None else f", MIS weight {weight:.6g} ({pdfs})"


def _ratio(weighted: Any, plain: Any) -> float | None:
    """weighted / plain by their largest channel; None where there is none."""
    channel = int(np.argmax(np.abs(plain)))
    return float(weighted[channel] / plain[channel]) if plain[channel] != 0.0 and np.isfinite(plain[channel]) else None
