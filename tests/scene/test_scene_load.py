"""What a scene becomes: defaults, values, shared objects, files."""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from lumiere.errors import SceneError
from lumiere.scene.fields import texture
from lumiere.scene.load import load
from lumiere.scene.model import Film, Integrator, Sampler
from lumiere.texture import TEXTURES, Texture

ROOT = Path(__file__).parents[2]
REFERENCES = ROOT.parent / "shared" / "refs"


def test_nothing_is_required() -> None:
    scene = load({"scene": {}})
    assert scene.camera is None
    assert scene.path is None
    assert (scene.film, scene.integrator, scene.sampler) == (Film(), Integrator(), Sampler())
    assert (scene.materials, scene.textures, scene.geometry, scene.lights) == ({}, {}, [], [])
    film, integrator, sampler = scene.film, scene.integrator, scene.sampler
    assert (film.width, film.height, film.crop, film.window, film.aovs) == (512, 512, None, (0, 0, 512, 512), ())
    assert (film.filter.type, film.filter.extent, film.exposure, film.tonemap) == ("box", 0.5, 0.0, "none")
    assert (integrator.type, integrator.max_depth, integrator.russian_roulette_depth) == ("path", 16, 5)
    assert (integrator.light_sampling, integrator.clamp_indirect) == ("mis", None)
    assert (sampler.type, sampler.spp, sampler.seed, sampler.adaptive) == ("sobol", 64, 0, None)


def test_given_values() -> None:
    scene = load({"scene": {
        "film": {"width": 20, "height": 10, "crop": [1, 2, 20, 10], "filter": {"type": "mitchell", "radius": 3}, "aovs": ["depth", "albedo"],
                 "exposure": -1, "tonemap": "agx"},
        "integrator": {"type": "direct", "max_depth": 0, "russian_roulette_depth": None, "light_sampling": "bsdf", "clamp_indirect": 10},
        "sampler": {"type": "independent", "spp": 1, "seed": 2**32 - 1}}})
    film, integrator, sampler = scene.film, scene.integrator, scene.sampler
    assert (film.width, film.height, film.crop, film.window) == (20, 10, (1, 2, 20, 10), (1, 2, 20, 10))
    assert (film.filter.type, film.filter.radius, film.aovs, film.exposure, film.tonemap) == ("mitchell", 3.0, ("depth", "albedo"), -1.0, "agx")
    assert isinstance(film.exposure, float)
    assert (integrator.type, integrator.max_depth, integrator.russian_roulette_depth) == ("direct", 0, None)
    assert (integrator.light_sampling, integrator.clamp_indirect) == ("bsdf", 10.0)
    assert (sampler.type, sampler.spp, sampler.seed) == ("independent", 1, 2**32 - 1)


def test_camera_defaults_to_perspective() -> None:
    camera = load({"scene": {"camera": {"position": [0, 1, 5], "fov": 30}}}).camera
    assert (camera.type, camera.position, camera.fov, camera.fov_axis) == ("perspective", (0.0, 1.0, 5.0), 30.0, "y")
    assert load({"scene": {"camera": {"type": "panorama"}}}).camera.type == "panorama"


def test_the_example_of_the_format(tmp_path: Path) -> None:
    """The first scene that a reader of the format sees loads as it stands."""
    text = re.search(r"```json\n(.*?)```", (ROOT / "docs" / "scene-format.md").read_text(encoding="utf-8"), re.DOTALL).group(1)
    (tmp_path / "s.json").write_text(text)
    scene = load(tmp_path / "s.json")
    (sphere,), (light,) = scene.geometry, scene.lights
    assert (sphere.type, sphere.position, sphere.radius, sphere.material, sphere.emission) == ("sphere", (0.0, 0.0, 0.0), 2.0, None, None)
    assert (light.type, light.position, light.intensity) == ("point", (0.0, 5.0, 0.0), (1.0, 1.0, 1.0))


def test_names_stand_for_one_object() -> None:
    scene = load({"scene": {
        "textures": {"wood": {"type": "checker", "scale": 10}, "unused": {"type": "constant"}},
        "materials": {"a": {"type": "lambert", "albedo": {"texture": "wood"}}, "b": {"type": "lambert", "albedo": {"texture": "wood"}},
                      "c": {"type": "lambert", "albedo": {"type": "constant", "value": 0.25}}},
        "geometry": [{"type": "sphere", "material": "a"}, {"type": "box", "material": "a"}, {"type": "disk", "material": {"type": "mirror"}},
                     {"type": "plane", "material": None}]}})
    wood = scene.textures["wood"]
    assert (wood.name, wood.scale) == ("wood", (10.0, 10.0))
    assert scene.materials["a"].albedo is wood
    assert scene.materials["b"].albedo is wood
    assert scene.materials["c"].albedo.value == (0.25, 0.25, 0.25)
    assert [material.name for material in scene.materials.values()] == ["a", "b", "c"]
    sphere, box, disk, plane = scene.geometry
    assert sphere.material is scene.materials["a"]
    assert box.material is sphere.material
    assert (disk.material.type, disk.material.name) == ("mirror", "")
    assert plane.material is None
    assert set(scene.textures) == {"wood", "unused"}


@pytest.fixture
def nest(monkeypatch: pytest.MonkeyPatch) -> None:
    """A kind of texture that takes a texture."""
    @dataclass(kw_only=True)
    class Nest(Texture):
        type: ClassVar[str] = "nest"
        of: Any = texture()

    TEXTURES.kinds()
    monkeypatch.setitem(TEXTURES._kinds, "nest", Nest)


@pytest.mark.usefixtures("nest")
def test_names_may_lead_to_names() -> None:
    def chain(length: int) -> dict:
        links = {str(i): {"type": "nest", "of": {"texture": str(i + 1)}} for i in range(length)}
        return {"scene": {"textures": {**links, str(length): {"type": "constant"}}}}

    textures = load(chain(20)).textures
    assert textures["7"].of is textures["8"]
    with pytest.raises(SceneError, match=r"^scene\.textures\[\"64\"\]: found materials or textures that lead to each other over more than 64 levels"):
        load(chain(500))
    with pytest.raises(SceneError, match=r"^scene\.textures\.b\.of\.texture: found \"a\" inside itself, expected a texture that does not lead back"):
        load({"scene": {"textures": {"a": {"type": "nest", "of": {"texture": "b"}}, "b": {"type": "nest", "of": {"texture": "a"}}}}})


@pytest.mark.parametrize(("written", "expected"), [
    (0.5, (0.5, 0.5, 0.5)),
    (1, (1.0, 1.0, 1.0)),
    ([0, 0.25, 1], (0.0, 0.25, 1.0)),
    ("#ffffff", (1.0, 1.0, 1.0)),
    ("#000000", (0.0, 0.0, 0.0)),
    ("#FF8000", (1.0, 0.21586050011389926, 0.0)),  # ((128/255 + 0.055) / 1.055)^2.4
    ("#004000", (0.0, 0.05126945837404324, 0.0)),
    ("#0a0000", (10 / 255 / 12.92, 0.0, 0.0)),
])
def test_spectra(written: object, expected: tuple) -> None:
    material = load({"scene": {"materials": {"m": {"type": "lambert", "albedo": written}}}}).materials["m"]
    assert material.albedo == pytest.approx(expected, rel=1e-14)
    assert all(isinstance(channel, float) for channel in material.albedo)


@pytest.mark.parametrize("vertices", [
    [[0, 0, 0], [1, 0, 0], [0, 1, 0.5]],
    [0, 0, 0, 1, 0, 0, 0, 1, 0.5],
    ((0, 0, 0), (1, 0, 0), (0, 1, 0.5)),
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.5]], dtype=np.float32),
])
def test_arrays(vertices: object) -> None:
    mesh = load({"scene": {"geometry": [{"type": "mesh", "vertices": vertices, "faces": np.array([0, 1, 2], dtype=np.uint32)}]}}).geometry[0]
    np.testing.assert_array_equal(mesh.vertices, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]])
    assert (mesh.vertices.dtype, mesh.faces.dtype, mesh.faces.shape) == (np.float64, np.int64, (1, 3))


def test_integers_beyond_64_bits_are_still_floats() -> None:
    mesh = load({"scene": {"geometry": [{"type": "mesh", "vertices": [10**25, -(10**25), 0], "faces": [0, 0, 0]}]}}).geometry[0]
    np.testing.assert_array_equal(mesh.vertices, [[1e25, -1e25, 0.0]])


def test_arrays_in_a_file(tmp_path: Path) -> None:
    """Comments and trailing commas among the numbers change nothing."""
    (tmp_path / "s.json").write_text("""{"scene": {"geometry": [
        {"type": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], /* the top */ [0, 1, 0.5],], "faces": [0, 1, 2, // front
            2, 1, 0,]}]}}""")
    mesh = load(tmp_path / "s.json").geometry[0]
    np.testing.assert_array_equal(mesh.vertices, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]])
    np.testing.assert_array_equal(mesh.faces, [[0, 1, 2], [2, 1, 0]])


def test_files_are_relative_to_the_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scenes").mkdir()
    (tmp_path / "cow.ply").touch()
    scene = {"scene": {"geometry": [{"type": "mesh", "file": "../cow.ply"}]}}
    (tmp_path / "scenes" / "s.json").write_text(json.dumps(scene))
    monkeypatch.chdir(tmp_path)
    file = load("scenes/s.json").geometry[0].file
    assert file.is_absolute()
    assert file.samefile("cow.ply")
    monkeypatch.chdir(tmp_path / "scenes")
    assert load(scene).geometry[0].file.samefile("../cow.ply")
    scene["scene"]["geometry"][0]["file"] = tmp_path / "cow.ply"
    assert load(scene).geometry[0].file == tmp_path / "cow.ply"


def test_a_file_that_may_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cow.ply").touch()
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(SceneError, match="which may not be read, expected a readable file"):
        load({"scene": {"geometry": [{"type": "mesh", "file": str(tmp_path / "cow.ply")}]}})


def test_hash_and_path(tmp_path: Path) -> None:
    data = b'{"scene": {} /* empty */}'
    (tmp_path / "s.json").write_bytes(data)
    scene = load(str(tmp_path / "s.json"))
    assert scene.path == tmp_path / "s.json"
    assert scene.text_hash == hashlib.sha256(data).hexdigest()
    film, other = {"width": 4, "height": 5}, {"height": 5, "width": 4}
    assert load({"scene": {"film": film}}).text_hash == load({"scene": {"film": other}}).text_hash
    assert load({"scene": {"film": film}}).text_hash != load({"scene": {}}).text_hash


def test_place(tmp_path: Path) -> None:
    """Later stages can say where a thing that they cannot use was written."""
    path = tmp_path / "s.json"
    path.write_text('{"scene": {"materials": {"m": {"type": "lambert"}},\n  "geometry": [{"type": "box"}, {"type": "sphere", "material": "m"}]}}')
    scene = load(path)
    assert scene.place(scene.geometry[1]) == f"{path}:2:33: scene.geometry[1]"
    assert scene.place(scene.geometry[1].material) == f"{path}:1:31: scene.materials.m"
    assert scene.place(scene.film) == "the scene"
    scene = load({"scene": {"lights": [{"type": "point"}]}})
    assert scene.place(scene.lights[0]) == "scene.lights[0]"


def test_a_big_file(tmp_path: Path) -> None:
    """300,000 numbers keep their values and, where one is wrong, its place."""
    rows = [[i, i + 0.5, -i] for i in range(100_000)]
    lines = [f"[{x}, {y}, {z}]" for x, y, z in rows]
    text = '{{"scene": {{"geometry": [{{"type": "mesh", "faces": [0, 1, 2], "vertices": [\n{}\n]}}]}}}}'
    (tmp_path / "s.json").write_text(text.format(",\n".join(lines)))
    np.testing.assert_array_equal(load(tmp_path / "s.json").geometry[0].vertices, rows)
    lines[99_998] = "[1, 1e999, 2]"
    (tmp_path / "s.json").write_text(text.format(",\n".join(lines)))
    with pytest.raises(SceneError, match=r"s\.json:100000:5: scene\.geometry\[0\]\.vertices\[99998\]\[1\]: found Infinity, expected a finite number"):
        load(tmp_path / "s.json")


@pytest.mark.skipif(not REFERENCES.is_dir(), reason="the reference scenes are not here")
@pytest.mark.parametrize("name", ["cow_in_sun", "delta_lights", "fog", "ggx_glass", "ggx_plates", "lens", "room_spheres", "shapes_as_lights"])
def test_reference_scenes(name: str) -> None:
    path = REFERENCES / f"{name}.json"
    if name == "fog":
        with pytest.raises(SceneError, match=r"fog\.json:251:12: scene\.media: not supported yet: media$"):
            load(path)
        return
    scene = load(path)
    document = json.loads(path.read_text())["scene"]
    assert scene.camera.type == document["camera"]["type"]
    assert [shape.type for shape in scene.geometry] == [shape["type"] for shape in document["geometry"]]
    assert [shape.material.name for shape in scene.geometry] == [shape["material"] for shape in document["geometry"]]
    assert {name: material.type for name, material in scene.materials.items()} == {n: m["type"] for n, m in document["materials"].items()}
    assert [light.type for light in scene.lights] == [light["type"] for light in document["lights"]]


def test_importing_the_loader_does_not_import_the_kinds() -> None:
    """Kinds, and the libraries that they need, are imported by the first scene that asks for one."""
    late = ["trimesh", "OpenImageIO", "pyopencl", "scipy", "lumiere.shape.mesh"]
    code = f"import sys, lumiere.scene.load; print([name for name in {late} if name in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True).stdout == "[]\n"
