"""Nothing is compiled, carried or uploaded that the scene does not ask for; and what is only a value builds nothing anew."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable

import pyopencl as cl
import pytest

from lumiere.bsdf import MATERIALS, Material
from lumiere.compile.scene import SceneBuffers, compile_scene
from lumiere.film.record import record_json
from lumiere.paths import cl_root
from lumiere.scene.load import load
from lumiere.wavefront.policy import Policy
from lumiere.wavefront.source import program_sources
from lumiere.wavefront.state import path_fields, path_source
from tests.render.preprocess import active_lines
from tests.render.scenes import Json, index_of, render

DENSE = Policy(compacted=False, work_group=64, slots=4096, batch=1 << 16, rounds=8)

PLAIN: Json = {
    "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0], "fov": 40},
    "film": {"width": 16, "height": 16},
    "materials": {"white": {"type": "lambert", "albedo": 0.5}},
    "geometry": [{"type": "box", "material": "white"}],
    "lights": [{"type": "area", "transform": [{"scale": 0.4}, {"rotate": {"axis": [1, 0, 0], "angle": 90}}, {"translate": [0, 3, 0]}], "radiance": 5}],
}
"""A box of one Lambertian material under one quad light."""


def compiled(scene: Json) -> SceneBuffers:
    return compile_scene(load({"scene": scene}))


def texts(scene: Json) -> dict[str, str]:
    return {source.name: source.text for source in program_sources(compiled(scene), DENSE)}


def changed(change: Callable[[Json], None], base: Json = PLAIN) -> Json:
    scene = copy.deepcopy(base)
    change(scene)
    return scene


def parts_of(text: str) -> set[str]:
    """Names of the files below cl/ whose functions a compiler sees in ``text``, of the folders where a file is a kind of something; as they stand, or
    for sixteen paths (cl/lib/lanes.cl)."""
    seen = re.sub(r"\b(float|uint|int)16\b", r"\1", re.sub(r"_lanes\b", "", active_lines(text)))
    found = set()
    for folder in ("bsdf", "light", "texture", "camera", "sampler", "shape"):
        for path in sorted((cl_root() / folder).glob("*.cl")):
            functions = re.findall(r"^static inline \w+ \**(\w+)\(", path.read_text(encoding="utf-8"), re.MULTILINE)
            bodies = [f"{folder}/{path.stem}" for name in functions if re.search(rf"^static inline \w+ \**{name}\(", seen, re.MULTILINE)]
            # Cameras and samplers name their functions alike: there, the body tells.
            if folder in ("camera", "sampler") and bodies:
                body = re.sub(r"\s+", " ", active_lines(path.read_text(encoding="utf-8")))
                bodies = bodies if re.sub(r"\s+", " ", body).strip()[-80:] in re.sub(r"\s+", " ", seen) else []
            found.update(bodies)
    return found


def test_plain_scene_compiles_nothing_else() -> None:
    sources = texts(PLAIN)
    assert list(sources) == ["generate", "extend", "shade[lambert]", "connect", "accumulate"]
    seen = {name: parts_of(text) for name, text in sources.items()}
    kinds = set().union(*seen.values())
    needed = {"bsdf/contract", "bsdf/lambert", "light/shape", "camera/perspective", "sampler/sobol", "shape/triangle"}
    assert needed <= kinds <= needed | {"shape/triangle_test", "shape/triangle_block", "shape/triangle_point", "shape/triangle_lanes", "shape/triangles_met",
                                        "light/shape_lanes"}
    assert not any(part.startswith("bsdf/") for name in ("generate", "extend", "connect", "accumulate") for part in seen[name])
    assert not any(part.startswith(("shape/", "light/")) for name in ("generate", "accumulate") for part in seen[name])


@pytest.mark.parametrize("word", ["microfacet", "ggx", "fresnel", "texture", "texel", "environment", "aperture", "opacity", "normal_map", "bump", "uv", "dpdu",
                                  "eta_scale", "clamp_indirect", "albedo", "ray_mask", "vertex_normals", "filter_table", "strata_x",
                                  "escape", "infinite_light"])
def test_plain_scene_says_nothing_of(word: str) -> None:
    """After preprocessing, no identifier of a feature that the scene has not. Only shade, which holds the BSDF, knows of an albedo."""
    for name, text in texts(PLAIN).items():
        code = active_lines(text)
        # Unused constants and the records' declarations cost nothing.
        code = "\n".join(line for line in code.splitlines() if not line.lstrip().startswith("#define"))
        code = re.sub(r"typedef struct \{[^}]*\} \w+;", "", code)
        if word == "albedo" and name.startswith("shade"):
            continue
        assert not re.search(rf"\b\w*{word}\w*\b", code), f"{name}: {re.search(rf'.*{word}.*', code)[0].strip()}"


def test_plain_scene_carries_nothing_else() -> None:
    def carried(scene: Json) -> set[str]:
        features = compiled(scene).features
        names = {field.name for field in path_fields(features)}
        declared = set(re.findall(r"path_get_(\w+)\(", path_source(features, lanes=False)))
        assert declared == names
        return names

    plain = carried(PLAIN)
    assert {"origin", "direction", "throughput", "bsdf_pdf", "shadow_origin", "contribution"} <= plain and "eta_scale" not in plain
    glass = carried(changed(lambda s: s["geometry"].append({"type": "box", "min": [2, 2, 2], "max": [3, 3, 3], "material": {"type": "dielectric"}})))
    assert glass == plain | {"eta_scale"}
    # No ray meets a point light: no density is weighed against another.
    assert carried(PLAIN | {"lights": [{"type": "point", "position": [0, 3, 0]}]}) == plain - {"bsdf_pdf"}
    only_seen = carried(PLAIN | {"lights": [], "geometry": [PLAIN["geometry"][0] | {"emission": 1}], "integrator": {"max_depth": 0}})
    assert only_seen == {name for name in plain if not name.startswith("shadow") and name != "contribution"}


def test_plain_scene_uploads_nothing_else() -> None:
    names = set(compiled(PLAIN).arrays)
    geometry = {name for name in names if name.startswith("triangle_")}
    assert names - geometry == {"render", "camera", "primitive_objects", "objects", "lambert_materials", "emissions", "light_cdf", "emitters"}
    assert not geometry & {"triangle_corners"}
    assert compiled(PLAIN).arrays["objects"][1].dtype.names == ("material", "flags", "emission")


def test_record_says_what_was_built(device: cl.Device) -> None:
    record = render(device, PLAIN, spp=1).record
    features = record["features"]
    assert list(features["bsdfs"]) == ["lambert"] and list(features["shapes"]) == ["triangle"]
    assert features["camera"] == "perspective" and features["sampler"] == "sobol" and features["emitters"]
    assert not set(features) & {"lights", "infinite_lights", "textures", "opacity", "visibility", "normal_map", "bump_map", "eta_scale", "camera_lens",
                                "clamp_indirect", "aovs", "filter_table", "vertex_normals", "surface_uv"}
    assert [kernel["name"] for kernel in record["kernels"]] == ["generate", "extend", "shade[lambert]", "connect", "accumulate"]
    other_values = ("colour", "power", "camera moved", "field of view", "resolution", "crop")
    again = render(device, changed(lambda s: [VALUES[name](s) for name in other_values]), spp=2).record
    assert all(kernel["reason"].startswith("none") for kernel in again["kernels"]), "a value built a program anew"
    assert again["bytes_per_path"] == record["bytes_per_path"] > 0


def test_the_record_says_how_the_picture_was_made(device: cl.Device) -> None:
    from_above = changed(lambda s: s["camera"].update(position=[0, 3, 4]))
    record = json.loads(record_json(render(device, from_above, spp=3, max_depth=2, crop=(4, 2, 12, 12)).record))
    assert set(record) == {"scene", "scene_hash", "version", "device", "driver", "options", "spp", "seed", "features", "bias", "kernels", "bytes_per_path",
                           "paths_in_flight", "seconds", "samples_per_second", "rays", "triangles_dropped", "memory", "non_finite"}
    assert record["options"] == {"spp": 3, "seed": 0, "width": 16, "height": 16, "crop": [4, 2, 12, 12], "max_depth": 2, "device": index_of(device),
                                 "time_limit": None, "target_error": None}
    seconds = record["seconds"]
    assert list(seconds) == ["load", "accelerator", "compile", "render", "total"]
    assert seconds["render"] > 0.0 and seconds["total"] == pytest.approx(sum(seconds.values()) - seconds["total"], abs=1e-3)
    assert record["samples_per_second"] == pytest.approx(3 * 80 / seconds["render"], rel=0.2)
    assert record["rays"]["nearest"] >= 3 * 80 and record["rays"]["shadow"] > 0
    assert record["memory"]["host_peak"] > record["memory"]["device_peak"] > 4 * record["bytes_per_path"]
    assert record["device"] == device.name.strip() and len(record["scene_hash"]) == 64


VALUES: dict[str, Callable[[Json], None]] = {
    "colour": lambda s: s["materials"]["white"].update(albedo=[0.1, 0.2, 0.3]),
    "power": lambda s: s["lights"][0].update(radiance=[1, 2, 3]),
    "light moved": lambda s: s["lights"][0]["transform"].append({"translate": [0.5, 0, 0]}),
    "resolution": lambda s: s["film"].update(width=640, height=333),
    "crop": lambda s: s["film"].update(crop=[1, 2, 7, 9]),
    "box filter's radius": lambda s: s["film"].update(filter={"type": "box", "radius": 1.0}),
    "camera moved": lambda s: s["camera"].update(position=[1, 2, 3]),
    "field of view": lambda s: s["camera"].update(fov=70),
    "samples": lambda s: s.update(sampler={"spp": 7}),
    "seed": lambda s: s.update(sampler={"seed": 7}),
    "depth": lambda s: s.update(integrator={"max_depth": 3}),
    "roulette": lambda s: s.update(integrator={"russian_roulette_depth": None}),
    "direct": lambda s: s.update(integrator={"type": "direct"}),
    "exposure": lambda s: s["film"].update(exposure=2.0, tonemap="aces"),
    "a second material": lambda s: (s["materials"].update(red={"type": "lambert", "albedo": [1, 0, 0]}),
                                    s["geometry"].append({"type": "box", "min": [2, 0, 0], "max": [3, 1, 1], "material": "red"})),
    "a second light": lambda s: s["lights"].append(copy.deepcopy(s["lights"][0])),
    "both sides": lambda s: s["lights"][0].update(sides="both"),
    "one-sided": lambda s: s["materials"]["white"].update(two_sided=False),
    "sample count and variance": lambda s: s["film"].update(aovs=["variance", "sample_count"]),
}


@pytest.mark.parametrize("name", VALUES)
def test_values_build_nothing(name: str) -> None:
    assert texts(changed(VALUES[name])) == texts(PLAIN)


FEATURES: dict[str, Callable[[Json], None]] = {
    "another material kind": lambda s: s["materials"].update(white={"type": "mirror"}),
    "another shape kind": lambda s: s["geometry"].append({"type": "sphere"}),
    "another light kind": lambda s: s["lights"].append({"type": "point"}),
    "another camera": lambda s: s["camera"].update(type="panorama", fov=40) or s["camera"].pop("fov"),
    "another sampler": lambda s: s.update(sampler={"type": "independent"}),
    "another filter": lambda s: s["film"].update(filter={"type": "tent"}),
    "a texture": lambda s: s["materials"]["white"].update(albedo={"type": "checker"}),
    "opacity": lambda s: s["materials"]["white"].update(opacity=0.5),
    "visibility": lambda s: s["geometry"][0].update(visible={"shadow": False}),
    "a layer": lambda s: s["film"].update(aovs=["normal"]),
    "a clamp": lambda s: s.update(integrator={"clamp_indirect": 1}),
    "another technique": lambda s: s.update(integrator={"light_sampling": "bsdf"}),
}


@pytest.mark.parametrize("name", FEATURES)
def test_features_build_programs(name: str) -> None:
    """The counterpart: what should make a difference does."""
    assert texts(changed(FEATURES[name])) != texts(PLAIN)


RICH: Json = {
    "materials": {"a": {"type": "lambert", "albedo": {"type": "checker"}}, "b": {"type": "conductor", "roughness": 0.3}},
    "geometry": [{"type": "sphere", "material": "a"}, {"type": "plane", "material": "b"}, {"type": "disk", "material": "a"}],
    "lights": [{"type": "point"}, {"type": "directional", "angle": 1}, {"type": "environment"}],
}


@pytest.mark.parametrize("what", ["sphere", "plane", "disk", "point", "directional", "material", "texture"])
def test_second_of_a_kind_builds_nothing(what: str) -> None:
    def add(s: Json) -> None:
        if what in ("sphere", "plane", "disk"):
            s["geometry"].append({"type": what, "position": [0, 3, 0], "material": "a"})
        elif what == "point":
            s["lights"].append({"type": "point", "position": [1, 2, 3], "intensity": 4})
        elif what == "directional":
            s["lights"].append({"type": "directional", "angle": 2, "irradiance": 3})
        elif what == "material":
            s["materials"]["c"] = {"type": "conductor", "roughness": 0.6, "metal": "gold"}
            s["geometry"].append({"type": "sphere", "position": [0, 3, 0], "material": "c"})
        else:
            s["materials"]["c"] = {"type": "lambert", "albedo": {"type": "checker", "scale": 3}}
            s["geometry"].append({"type": "sphere", "position": [0, 3, 0], "material": "c"})

    assert texts(changed(add, RICH)) == texts(RICH)


@pytest.mark.parametrize("kind", [kind for kind, cls in MATERIALS.kinds().items() if cls.examples()])
def test_ten_more_materials_of_a_kind_build_nothing(kind: str) -> None:
    def built(materials: list[Material]) -> dict[str, str]:
        scene = load({"scene": {"geometry": [{"type": "sphere", "position": [3 * i, 0, 0]} for i in range(11)]}})
        for number, shape in enumerate(scene.geometry):
            shape.material = materials[number % len(materials)]
        return {source.name: source.text for source in program_sources(compile_scene(scene), DENSE)}

    first = MATERIALS.kinds()[kind].examples()[0]
    assert built([first]) == built([copy.deepcopy(first) for _ in range(11)])
