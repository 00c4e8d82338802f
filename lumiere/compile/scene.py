"""Scene → arrays and Features: exactly what this scene uses."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lumiere.accel import Choice, choose, with_packets
from lumiere.bsdf import Body, Material
from lumiere.bsdf.lambert import Lambert
from lumiere.bsdf.mix import Mix
from lumiere.camera import Camera
from lumiere.camera.perspective import Perspective
from lumiere.compile.features import Features
from lumiere.compile.geometry import Object, ShapeGroup, Vertices, group_shapes, joined
from lumiere.compile.lights import LightTable, light_table, mean_emission
from lumiere.compile.materials import NO_TEXTURE, MaterialTable
from lumiere.compile.mix import Row, rows_of
from lumiere.compile.recentre import far_center, moved
from lumiere.compile.textures import SRGB_VALUES, TextureTable
from lumiere.device.array import Array, DeviceArray
from lumiere.device.source import c_struct
from lumiere.errors import SceneError
from lumiere.light import Light
from lumiere.light.environment import EnvironmentLight
from lumiere.scene.model import Scene
from lumiere.texture import Texture
from lumiere.wavefront.batch import FEWEST_ENTRIES

BODY = np.dtype([("priority", "<u4"), ("ior", "<f4"), ("absorption", "<f4", 3)])

TWO_SIDED, VISIBLE_TO_CAMERA, VISIBLE_TO_SHADOW, TRANSLUCENT = 1, 2, 4, 8


@dataclass
class SceneBuffers:
    """What the device gets, or has: arrays by name with the C type of their elements, the structs that those are made of, and Features."""

    features: Features
    arrays: dict[str, tuple[str, Array]] = field(default_factory=dict)
    structs: dict[str, np.dtype] = field(default_factory=dict)
    bsdf_parameters: dict[str, dict[str, str]] = field(default_factory=dict)
    dropped: dict[str, int] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    origin: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """What is at the device's origin, in the file's coordinates."""

    def add(self, name: str, c_type: str, array: Array) -> None:
        """Adds a buffer; ``c_type`` is ``float``, ``uint`` or a struct's name, then declared by the array's dtype."""
        if array.dtype.names:
            self.structs[c_type] = array.dtype
        self.arrays[name] = (c_type, array if isinstance(array, DeviceArray) else np.ascontiguousarray(array))

    @property
    def bytes(self) -> int:
        """Bytes of all buffers."""
        return sum(array.nbytes for _, array in self.arrays.values())

    def struct_source(self) -> str:
        """C declarations of all structs."""
        return "\n".join(c_struct(name, dtype) for name, dtype in self.structs.items())


def compile_scene(scene: Scene, *, wide: bool = True, packets: bool = False, choose_accelerator: Choice = choose) -> SceneBuffers:
    """Compiles a validated scene, for a device with wide vectors (CPUs) or without; ``packets``: its queues let sixteen neighbours be traced
    together. Raises SceneError, which says where in the scene that is, where a file that it names is not what it should be.
    """
    with scene.placing_errors():
        return _compile(scene, wide, packets, choose_accelerator)


def _compile(scene: Scene, wide: bool, packets: bool, choose_accelerator: Choice) -> SceneBuffers:
    objects, lights = lower(scene)
    # The layer `position` is in the file's coordinates, so with it the scene stays where it is.
    origin = None if "position" in scene.film.aovs else far_center(objects)
    if origin is not None:
        scene = moved(scene, origin)
        objects, lights = lower(scene)
    textures = TextureTable()
    materials = MaterialTable(textures, scene.integrator.energy_compensation)
    rows = rows_of(objects)
    places = [("", 0) if row.mixed else materials.place(row.material) for row in rows]
    emissive = any(mean_emission(o.emission) > 0.0 for o in objects)
    if not lights and not emissive:
        lights = [EnvironmentLight()]
    records = {kind: materials.records(kind) for kind in materials.members}
    emissions, emission_of = _emissions(objects, textures)
    maps = [_maps(row, textures) for row in rows]

    uses_uv = "uv" in textures.uses or "uv" in scene.film.aovs
    tangent = any(row.material.needs_tangent for row in rows) or "footprint" in textures.uses
    uses_uv = uses_uv or tangent
    has_normals = any(o.primitives.normals is not None for o in objects)
    keep = (("normals",) if has_normals else ()) + (("uvs",) if uses_uv else ()) + (("colors",) if "color" in textures.uses else ())
    begin = time.perf_counter()
    if packets and not _tells_rays_apart(objects, rows):
        choose_accelerator = with_packets(choose_accelerator)
    groups, vertices = group_shapes(objects, keep, wide, choose_accelerator)
    accelerator_seconds = time.perf_counter() - begin
    center, radius = scene_bounds(groups)
    table = light_table(lights, objects, groups, radius)
    camera = scene.camera or _framing_camera(center, radius)

    features = _features(scene, objects, rows, groups, vertices, materials, table, camera, emissive=emissive and len(emissions) > 0,
                         uses_uv=uses_uv, tangent=tangent, textured_emission=any(isinstance(o.emission, Texture) for o in objects))
    buffers = SceneBuffers(features, bsdf_parameters={kind: materials.parameters[kind] for kind in sorted(materials.members)})
    if origin is not None:
        buffers.origin = origin
    buffers.seconds["accelerator"] = accelerator_seconds
    if features.pixel_list:
        x0, y0, x1, y1 = scene.film.window
        buffers.add("pixel_list", "uint2", np.zeros((max((x1 - x0) * (y1 - y0), FEWEST_ENTRIES), 2), dtype=np.uint32))
    for o in objects:
        for reason, count in o.primitives.dropped.items():
            buffers.dropped[reason] = buffers.dropped.get(reason, 0) + count
    _add_render(buffers, scene, groups, table)
    _add_camera(buffers, camera, scene.film.width, scene.film.height)
    _add_geometry(buffers, groups, vertices)
    _add_objects(buffers, rows, places, emission_of, maps)
    for kind in sorted(records):
        buffers.add(f"{kind}_materials", f"{kind}_record_t", records[kind])
    for kind in features.textures:
        kind_records = np.array(textures.records[kind])
        if kind_records.dtype.itemsize:
            buffers.add(f"{kind}_textures", f"{kind}_texture_t", kind_records)
    if textures.texels.words:
        buffers.add("texels", "uint", np.concatenate(textures.texels.words))
        buffers.add("srgb_values", "float", SRGB_VALUES)
    if features.emission:
        buffers.add("emissions", "emission_t", emissions)
    _add_lights(buffers, table)
    filter_table = scene.film.filter.table()
    if filter_table is not None:
        buffers.add("filter_table", "float", filter_table)
    return buffers


def lower(scene: Scene) -> tuple[list[Object], list[Light]]:
    """The objects of the scene, with the shapes that stand for its area lights, and the lights that are not shapes."""
    shapes = list(scene.geometry)
    lights = []
    for light in scene.lights:
        shape = light.lower()
        if shape is None:
            lights.append(light)
        else:
            shapes.append(shape)
    pictures = [light for light in lights if light.device_kind == "environment_image"]
    if len(pictures) > 1:
        raise SceneError("found a second environment with a file, expected at most one", pictures[1])
    default = Lambert()
    occlusion = Lambert(albedo=(1.0, 1.0, 1.0)) if scene.integrator.type == "ambient_occlusion" else None
    objects = []
    for shape in shapes:
        for primitives in shape.lower():
            material = primitives.material or shape.material or default
            emission = shape.emission if shape.emission is not None else material.emission
            sides = shape.emission_sides or material.emission_sides
            if occlusion is not None:
                # Ambient occlusion is what a white scene reflects, once, of a white sky.
                material, emission = occlusion, None
            if not isinstance(emission, Texture) and not any(emission or ()):
                emission = None
            objects.append(Object(shape, primitives, material, emission, sides == "both"))
    return objects, [EnvironmentLight()] if occlusion is not None else lights


def _tells_rays_apart(objects: list[Object], rows: list[Row]) -> bool:
    """Does what a ray meets depend on more than the ray: its path's random numbers, its kind, the body that it is in?"""
    return (any(_translucent(o.material) or not (o.shape.visible.camera and o.shape.visible.shadow) for o in objects)
            or any("WALKS" in row.material.device_features for row in rows if not row.mixed))


def scene_bounds(groups: list[ShapeGroup]) -> tuple[np.ndarray, float]:
    """Centre and radius of a sphere around everything bounded, metres; about the origin with radius 1 where nothing is."""
    corners = [group.bounds for group in groups if group.bounds is not None]
    if not corners:
        return np.zeros(3), 1.0
    lower = np.min([low for low, _ in corners], axis=0).astype(np.float64)
    upper = np.max([high for _, high in corners], axis=0).astype(np.float64)
    return (lower + upper) / 2.0, float(np.linalg.norm(upper - lower) / 2.0) or 1.0


def _framing_camera(center: np.ndarray, radius: float) -> Camera:
    """A camera that sees the whole of a sphere, from the front, a little to the right and above."""
    fov = 40.0
    direction = np.array([0.4, 0.3, 1.0]) / np.linalg.norm([0.4, 0.3, 1.0])
    position = center + direction * radius / math.sin(math.radians(fov / 2.0))
    return Perspective(position=tuple(position), look_at=tuple(center), fov=fov, fov_axis="smaller")


def _emissions(objects: list[Object], textures: TextureTable) -> tuple[np.ndarray, list[int]]:
    """Emission records, and for each object the number of its record or −1."""
    textured = any(isinstance(o.emission, Texture) for o in objects)
    dtype = np.dtype([("radiance", "<f4", 3), ("both_sides", "<i4")] + ([("texture", "<u4")] if textured else []))
    rows, numbers = [], []
    for o in objects:
        if o.emission is None:
            numbers.append(-1)
            continue
        numbers.append(len(rows))
        constant = (0.0, 0.0, 0.0) if isinstance(o.emission, Texture) else o.emission
        row: tuple[Any, ...] = (constant, o.both_sides)
        if textured:
            row += (textures.id(o.emission) if isinstance(o.emission, Texture) else NO_TEXTURE,)
        rows.append(row)
    return np.array(rows, dtype=dtype), numbers


def _features(scene: Scene, objects: list[Object], rows: list[Row], groups: list[ShapeGroup], vertices: Vertices, materials: MaterialTable,
              table: LightTable, camera: Camera, *, emissive: bool, uses_uv: bool, tangent: bool, textured_emission: bool) -> Features:
    kinds = tuple(table.kinds)
    infinite = tuple(kind for kind, members in table.kinds.items() if members[0].infinite)
    mode = scene.integrator.light_sampling
    delta = any(not members[0].infinite for members in table.kinds.values())
    used = [row.material for row in rows if not row.mixed]
    mixes = [row.material for row in rows if row.mixed]
    specular = tuple(sorted({m.device_kind for m in used if m.purely_specular}))
    scatters = scene.integrator.max_depth > 0 and any(not m.purely_specular for m in used)
    next_event = scatters and (delta or (table.count > 0 and mode != "bsdf"))
    colors = "color" in materials.textures.uses
    return Features(
        shapes={group.device_shape.name: group.layout for group in groups},
        shared_primitives=tuple(group.device_shape.name for group in groups if "references" in group.accelerator),
        bsdfs={kind: tuple(sorted(materials.textured[kind])) for kind in sorted(materials.members)},
        bsdf_features={kind: tuple(sorted(names)) for kind, names in materials.features.items()},
        camera=camera.type, sampler=scene.sampler.type, lights=kinds, infinite_lights=infinite, textures=tuple(materials.textures.kinds),
        emission=emissive, emitters=len(table.emitters) > 0, textured_emission=textured_emission, next_event_estimation=next_event,
        light_sampling=mode, bsdf_pdf=len(table.emitters) > 0 or bool(infinite), eta_scale=any(m.refracts for m in used),
        camera_lens=camera.uses_lens, camera_partial=camera.type == "fisheye", filter_table=scene.film.filter.table() is not None,
        clamp_indirect=scene.integrator.clamp_indirect is not None,
        opacity=any(_translucent(o.material) for o in objects), textured_opacity=any(isinstance(o.material.opacity, Texture) for o in objects),
        normal_map=any(row.normal_map is not None for row in rows), bump_map=any(row.bump_map is not None for row in rows),
        ray_cones="footprint" in materials.textures.uses,
        nested=any(row.material.body is not None for row in rows), subsurface=any("WALKS" in m.device_features for m in used),
        mixes=len(mixes) > 0, textured_mixes=any(isinstance(m.weight, Texture) for m in mixes),
        visibility=any(not (o.shape.visible.camera and o.shape.visible.shadow) for o in objects),
        triangle_corners=any(group.corners is not None for group in groups),
        vertex_normals=any(o.primitives.normals is not None for o in objects),
        vertex_uvs=uses_uv and any(o.primitives.uvs is not None for o in objects),
        vertex_colors=colors and any(o.primitives.colors is not None for o in objects),
        surface_uv=uses_uv, surface_tangent=tangent, surface_color=colors,
        pixel_list=scene.sampler.adaptive is not None,
        aovs=tuple(name for name in scene.film.aovs if name not in ("sample_count", "variance")), specular_bsdfs=specular)


def _add_render(buffers: SceneBuffers, scene: Scene, groups: list[ShapeGroup], table: LightTable) -> None:
    """The values of the whole render: changing one builds nothing."""
    film, integrator = scene.film, scene.integrator
    x0, y0, x1, y1 = film.crop or (0, 0, film.width, film.height)
    never = 0xFFFFFFFF
    depth = {"path": integrator.max_depth, "direct": min(integrator.max_depth, 1), "ambient_occlusion": 1}[integrator.type]
    roulette = integrator.russian_roulette_depth
    strata_x = max(1, round(math.sqrt(scene.sampler.spp)))
    values: dict[str, tuple[str, Any]] = {
        "width": ("<u4", film.width), "height": ("<u4", film.height), "crop_x": ("<u4", x0), "crop_y": ("<u4", y0),
        "crop_width": ("<u4", x1 - x0), "crop_height": ("<u4", y1 - y0), "seed": ("<u4", scene.sampler.seed), "max_depth": ("<u4", depth),
        "russian_roulette_depth": ("<u4", never if roulette is None or integrator.type == "ambient_occlusion" else max(1, roulette)),
        "filter_radius": ("<f4", film.filter.extent), "strata_x": ("<u4", strata_x),
        "strata_y": ("<u4", -(-scene.sampler.spp // strata_x)), "clamp_indirect": ("<f4", integrator.clamp_indirect or 0.0),
        "light_count": ("<u4", table.count), "emitter_count": ("<u4", len(table.emitters)),
    }
    first = 0
    for group in groups:
        values[f"{group.device_shape.name}_first"] = ("<u4", first)
        values[f"{group.device_shape.name}_count"] = ("<u4", len(group.objects))
        first += len(group.objects)
    for kind, members in table.kinds.items():
        values[f"{kind}_light_first"] = ("<u4", table.first(kind))
        values[f"{kind}_light_count"] = ("<u4", len(members))
    record = np.zeros(1, dtype=np.dtype([(name, sort) for name, (sort, _) in values.items()]))
    for name, (_, value) in values.items():
        record[name] = value
    buffers.add("render", "render_t", record)


def _add_camera(buffers: SceneBuffers, camera: Camera, width: int, height: int) -> None:
    fields: list[Any] = [("to_world", "<f4", (3, 4))]
    fields += [(name, "<f4", count) if count > 1 else (name, "<f4") for name, count in camera.device_fields.items()]
    record = np.zeros(1, dtype=np.dtype(fields))
    record["to_world"] = camera.to_world()[:3]
    for name, value in camera.device_values(width, height).items():
        record[name] = value
    buffers.add("camera", "camera_t", record)


def _add_geometry(buffers: SceneBuffers, groups: list[ShapeGroup], vertices: Vertices) -> None:
    for group in groups:
        name = group.device_shape.name
        if name == "triangle":
            buffers.add("triangle_vertices", "float", group.records["vertices"])
        else:
            buffers.add(f"{name}s", f"{name}_record_t", group.records)
        for key, array in group.accelerator.items():
            buffers.add(f"{name}_{key}", {"f": "float", "u": "uint", "i": "int"}[array.dtype.kind], array)
        if group.corners is not None:
            buffers.add("triangle_corners", "uint", group.corners)
    for feature, name, parts in (("vertex_normals", "vertex_normals", vertices.normals), ("vertex_uvs", "vertex_uvs", vertices.uvs),
                                 ("vertex_colors", "vertex_colors", vertices.colors)):
        if getattr(buffers.features, feature):
            buffers.add(name, "float", np.concatenate(parts).astype(np.float32))
    if groups:
        buffers.add("primitive_objects", "uint", joined([group.objects for group in groups]))


def _translucent(material: Material) -> bool:
    return isinstance(material.opacity, Texture) or material.opacity < 1.0


def _maps(row: Row, textures: TextureTable) -> dict[str, int]:
    """Device ids of the textures that a material carries whatever its kind, and of a mix's weight."""
    carried = {"opacity_texture": row.object.material.opacity, "normal_map": row.normal_map, "bump_map": row.bump_map,
               "mix_weight_texture": row.material.weight if isinstance(row.material, Mix) else None}
    return {name: textures.id(value) if isinstance(value, Texture) else NO_TEXTURE for name, value in carried.items()}


def _add_objects(buffers: SceneBuffers, rows: list[Row], places: list[tuple[str, int]], emission_of: list[int],
                 maps: list[dict[str, int]]) -> None:
    """The object table, with a column for each thing that some object of the scene has."""
    features = buffers.features
    queues = list(features.bsdfs)
    columns: list[tuple[str, str, bool]] = [
        ("material", "<u4", True), ("flags", "<u4", True), ("shade_queue", "<u4", len(queues) > 1),
        ("material_id", "<u4", "material_id" in features.aovs), ("emission", "<i4", features.emission), ("opacity", "<f4", features.opacity),
        ("opacity_texture", "<u4", features.textured_opacity), ("normal_map", "<u4", features.normal_map),
        ("body", "<u4", features.nested), ("bump_map", "<u4", features.bump_map), ("bump_scale", "<f4", features.bump_map), ("mix_a", "<u4", features.mixes),
        ("mix_b", "<u4", features.mixes), ("mix_weight", "<f4", features.mixes), ("mix_weight_texture", "<u4", features.textured_mixes)]
    records = np.zeros(len(rows), dtype=np.dtype([(name, sort) for name, sort, present in columns if present]))
    named: dict[int, int] = {}
    bodies = _bodies(rows)
    for record, row, (kind, index), textures in zip(records, rows, places, maps, strict=True):
        material, visible = row.object.material, row.object.shape.visible
        sides = row.material.two_sided if row.material.two_sided is not None else material.two_sided
        two_sided = row.material.reflective if sides is None else sides
        weight = row.material.weight if isinstance(row.material, Mix) else 0.0
        values = {
            "material": index, "shade_queue": 0 if row.mixed else queues.index(kind), "material_id": named.setdefault(id(material), len(named)),
            "flags": (TWO_SIDED * bool(two_sided) | VISIBLE_TO_CAMERA * visible.camera | VISIBLE_TO_SHADOW * visible.shadow
                      | TRANSLUCENT * _translucent(material)),
            "emission": emission_of[row.number], "opacity": 1.0 if isinstance(material.opacity, Texture) else material.opacity,
            "body": bodies.get(id(row.material), (0,))[0],
            "bump_scale": row.bump_scale, "mix_a": row.a, "mix_b": row.b, "mix_weight": 0.0 if isinstance(weight, Texture) else weight, **textures}
        for name in records.dtype.names or ():
            record[name] = values[name]
    if len(rows):
        buffers.add("objects", "object_t", records)
    if bodies:
        buffers.add("bodies", "body_t", np.array([(b.priority, b.ior, b.absorption) for _, b in bodies.values()], dtype=BODY))


def _bodies(rows: list[Row]) -> dict[int, tuple[int, Body]]:
    """By identity of the material: its body's number, from 1 on, and the body."""
    bodies: dict[int, tuple[int, Body]] = {}
    for row in rows:
        if row.material.body is not None:
            bodies.setdefault(id(row.material), (len(bodies) + 1, row.material.body))
    return bodies


def _add_lights(buffers: SceneBuffers, table: LightTable) -> None:
    for kind, members in table.kinds.items():
        record = np.zeros(len(members), dtype=members[0].record)
        for row, light in zip(record, members, strict=True):
            for name, value in light.device_record().items():
                row[name] = value
            for name, array in light.arrays().items():
                buffers.add(name, "float" if array.dtype.kind == "f" else "uint", array)
        buffers.add(f"{kind}_lights", f"{kind}_light_t", record)
    if table.cdf is not None and (buffers.features.next_event_estimation or buffers.features.bsdf_pdf):
        buffers.add("light_cdf", "uint", table.cdf)
    if buffers.features.emitters:
        buffers.add("emitters", "uint", table.emitters)
