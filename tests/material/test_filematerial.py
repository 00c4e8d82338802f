"""Materials of mesh files become ours: which parameter each factor and picture stands for."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lumiere.bsdf.lambert import Lambert
from lumiere.bsdf.mix import Mix
from lumiere.bsdf.principled import Principled
from lumiere.bsdf.thin_dielectric import ThinDielectric
from lumiere.compile.filematerial import material_of
from lumiere.errors import SceneError
from lumiere.meshfile import FileMaterial, load_mesh
from lumiere.texture.image import ImageTexture

PICTURE = np.zeros((2, 2, 4), np.uint8)


def written(folder: Path, material: dict[str, Any]) -> Path:
    """A glTF file of one triangle with the material; its one picture is ``picture.png``."""
    positions = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]).tobytes()
    (folder / "triangle.bin").write_bytes(positions)
    (folder / "picture.png").touch()
    document = {
        "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "buffers": [{"uri": "triangle.bin", "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}], "images": [{"uri": "picture.png"}], "textures": [{"source": 0}],
        "materials": [material]}
    path = folder / "triangle.gltf"
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def read(folder: Path, material: dict[str, Any]) -> FileMaterial:
    found = load_mesh(written(folder, material))[0].material
    assert found is not None
    return found


def test_factors_and_pictures() -> None:
    made = material_of(FileMaterial(base_color=(0.5, 0.6, 0.7), base_color_image=PICTURE, metallic=0.25, roughness=0.75, emission=(1.0, 2.0, 3.0),
                                    metallic_roughness_image=PICTURE, normal_image=PICTURE))
    assert isinstance(made, Principled)
    assert (made.base_color.encoding, made.base_color.channel, made.base_color.factor) == ("srgb", "rgb", (0.5, 0.6, 0.7))
    assert (made.metallic.encoding, made.metallic.channel, made.metallic.factor[0]) == ("linear", "b", 0.25)
    assert (made.roughness.encoding, made.roughness.channel, made.roughness.factor[0]) == ("linear", "g", 0.75)
    assert made.normal_map.encoding == "linear" and made.emission == (1.0, 2.0, 3.0) and made.two_sided and made.opacity == 1.0


def test_every_extension_is_read(tmp_path: Path) -> None:
    found = read(tmp_path, {"extensions": {
        "KHR_materials_ior": {"ior": 1.8},
        "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 0.5, 0.25], "specularTexture": {"index": 0}},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.7, "clearcoatRoughnessFactor": 0.2, "clearcoatTexture": {"index": 0}},
        "KHR_materials_sheen": {"sheenColorFactor": [0.1, 0.2, 0.3], "sheenRoughnessFactor": 0.6, "sheenRoughnessTexture": {"index": 0}},
        "KHR_materials_transmission": {"transmissionFactor": 0.9}, "KHR_materials_volume": {"thicknessFactor": 1},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.4}}})
    made = material_of(found)
    assert isinstance(made, Principled)
    assert (made.ior, made.specular_tint, made.transmission, made.anisotropy) == (1.8, (1.0, 0.5, 0.25), 0.9, 0.4)
    assert (made.specular.channel, made.specular.factor[0]) == ("a", 0.25)  # specularFactor 1 is our 0.5
    assert (made.clearcoat.channel, made.clearcoat.factor[0], made.clearcoat_roughness) == ("r", 0.7, 0.2)
    assert (made.sheen, made.sheen_roughness.channel) == ((0.1, 0.2, 0.3), "a")
    assert not made.two_sided and made.refracts


def test_a_file_without_extensions_has_no_lobe_of_theirs(tmp_path: Path) -> None:
    assert material_of(read(tmp_path, {})).device_features == Principled().device_features


def test_a_film_without_volume_bends_no_light(tmp_path: Path) -> None:
    made = material_of(read(tmp_path, {"emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.9}}}))
    assert isinstance(made, Mix) and made.check() is None and made.weight == 0.9 and made.emission == (1.0, 1.0, 1.0)
    assert isinstance(made.a, Principled) and isinstance(made.b, ThinDielectric)


def test_unlit_shows_its_colour_whatever_the_light(tmp_path: Path) -> None:
    found = read(tmp_path, {"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1]}, "extensions": {"KHR_materials_unlit": {}}})
    made = material_of(found)
    assert isinstance(made, Lambert) and made.albedo == (0.0, 0.0, 0.0) and made.emission == (0.1, 0.2, 0.3) and made.emission_sides == "both"


def test_normal_scale_scales_the_tilt() -> None:
    tilted = np.full((1, 1, 3), 255, np.uint8)
    tilted[..., 1] = 128
    made = material_of(FileMaterial(normal_image=tilted, normal_scale=0.5))
    x, _, z = 2.0 * made.normal_map.pixels[0, 0] - 1.0
    assert x / z == pytest.approx(0.5, rel=1e-3)


def test_alpha_modes() -> None:
    assert material_of(FileMaterial(opacity=0.3)).opacity == 1.0
    assert material_of(FileMaterial(opacity=0.3, alpha_mode="blend")).opacity == 0.3
    assert material_of(FileMaterial(opacity=0.3, alpha_mode="mask")).opacity == 0.0
    blended = material_of(FileMaterial(opacity=0.3, alpha_mode="blend", base_color_image=PICTURE)).opacity
    assert isinstance(blended, ImageTexture) and blended.channel == "a"


@pytest.mark.parametrize("extension", [{"KHR_materials_ior": {"ior": "glass"}}, {"KHR_materials_sheen": {"sheenColorFactor": [1, 2]}}])
def test_nonsense_is_one_line(tmp_path: Path, extension: dict[str, Any]) -> None:
    with pytest.raises(SceneError) as caught:
        load_mesh(written(tmp_path, {"extensions": extension}))
    assert "\n" not in str(caught.value) and "triangle.gltf" in str(caught.value)
