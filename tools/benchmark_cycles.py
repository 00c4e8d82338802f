"""Cycles, of Blender as a Python module, as a peer of the benchmark (tools/benchmark_peer.py): on the CPU, no denoiser, no adaptive sampling.

Seconds are those that Cycles gives as its render time, to a hundredth, in what it writes beside the picture: without the hand-over of the scene from
Blender and the making of the accelerator.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import numpy as np
from benchmark_peer import Mesh, Told, serve


def start(told: Told) -> tuple[str, Any]:
    """Makes the scene."""
    import bpy

    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    _settings(bpy, scene, told)
    _camera(bpy, scene, told)
    _sky(bpy, scene, told.values["sky"])
    for number, mesh in enumerate(told.meshes):
        _mesh(bpy, scene, f"mesh {number}", mesh)
    file = told.folder / "cycles.exr"

    def render(seed: int, spp: int) -> tuple[float, np.ndarray]:
        scene.cycles.seed, scene.cycles.samples = seed, spp
        bpy.ops.render.render()
        bpy.data.images["Render Result"].save_render(str(file))
        image = bpy.data.images.load(str(file))
        pixels = np.zeros(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
        width, height = told.size
        return render_seconds(file), pixels.reshape(height, width, -1)[::-1, :, :3]  # rows from below

    return f"Cycles of Blender {bpy.app.version_string}", render


def render_seconds(exr: Path) -> float:
    """The render time among the attributes of a picture, written [HOURS:]MINUTES:SECONDS."""
    found = re.search(rb"cycles\.[^\0]*\.render_time\0string\0....([0-9:.]+)", exr.read_bytes()[:1 << 16], re.DOTALL)
    seconds = 0.0
    for part in found.group(1).decode().split(":"):
        seconds = 60.0 * seconds + float(part)
    return seconds


def _settings(bpy: Any, scene: Any, told: Told) -> None:
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = told.size
    render.resolution_percentage = 100
    render.use_persistent_data = True
    render.threads_mode, render.threads = "FIXED", len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.view_settings.view_transform = "Raw"
    cycles.device = "CPU"
    cycles.use_denoising = cycles.use_adaptive_sampling = cycles.use_auto_tile = cycles.use_fast_gi = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    # The last bounce still finds light: as many scatterings are one bounce fewer.
    bounces = told.values["max_depth"] - 1
    cycles.max_bounces = cycles.diffuse_bounces = bounces
    cycles.min_light_bounces = min(bounces, told.values["roulette_depth"] or bounces)
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = cycles.blur_glossy = 0.0


def _camera(bpy: Any, scene: Any, told: Told) -> None:
    from mathutils import Matrix

    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle = "HORIZONTAL", told.view_angle
    data.clip_start, data.clip_end = 1e-3, 1e4
    camera = bpy.data.objects.new("camera", data)
    camera.matrix_world = Matrix(told.values["to_world"])
    scene.collection.objects.link(camera)
    scene.camera = camera


def _sky(bpy: Any, scene: Any, radiance: list[float] | None) -> None:
    world = scene.world or bpy.data.worlds.new("world")
    scene.world = world
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True  # always so, later
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = nodes["Background"]
    background.inputs["Color"].default_value = (*(radiance or (0.0, 0.0, 0.0)), 1.0)
    if radiance is None:
        return
    # Cycles samples no sky that it can tell to be the same everywhere. This one's strength is 1 where its coordinates' mean is above -2; of the
    # ways to say such a thing, and of the sizes of its map of the sky, those that it is fastest with (docs/performance.md).
    place, above = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMath")
    above.operation = "GREATER_THAN"
    above.inputs[1].default_value = -2.0
    links.new(place.outputs["Generated"], above.inputs[0])
    links.new(above.outputs[0], background.inputs["Strength"])
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 4


def _mesh(bpy: Any, scene: Any, name: str, mesh: Mesh) -> None:
    data = bpy.data.meshes.new(name)
    data.vertices.add(len(mesh.vertices))
    data.vertices.foreach_set("co", mesh.vertices.ravel())
    data.loops.add(mesh.faces.size)
    data.loops.foreach_set("vertex_index", mesh.faces.ravel())
    data.polygons.add(len(mesh.faces))
    data.polygons.foreach_set("loop_start", np.arange(0, mesh.faces.size, 3, dtype=np.int32))
    data.update()
    data.shade_flat()
    data.materials.append(_material(bpy, name, mesh))
    scene.collection.objects.link(bpy.data.objects.new(name, data))


def _material(bpy: Any, name: str, mesh: Mesh) -> Any:
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output, surface = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeBsdfDiffuse")
    surface.inputs["Color"].default_value = (*mesh.albedo, 1.0)
    surface.inputs["Roughness"].default_value = 0.0
    if mesh.emission:
        # Light leaves the front alone: strength 1 − backfacing.
        emission, geometry, front, both = (nodes.new(kind) for kind in (
            "ShaderNodeEmission", "ShaderNodeNewGeometry", "ShaderNodeMath", "ShaderNodeAddShader"))
        emission.inputs["Color"].default_value = (*mesh.emission, 1.0)
        front.operation = "SUBTRACT"
        front.inputs[0].default_value = 1.0
        links.new(geometry.outputs["Backfacing"], front.inputs[1])
        links.new(front.outputs[0], emission.inputs["Strength"])
        links.new(surface.outputs[0], both.inputs[0])
        links.new(emission.outputs[0], both.inputs[1])
        surface = both
        material.cycles.emission_sampling = "FRONT"
    links.new(surface.outputs[0], output.inputs["Surface"])
    return material


if __name__ == "__main__":
    serve(start)
