"""glTF and GLB: node transforms, ways to store arrays, materials, and what is wrong."""

from __future__ import annotations

import base64
import itertools
import json
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lumiere.errors import SceneError
from lumiere.meshfile import MeshPart, load_mesh
from tests.meshfile.samples import FACES, NORMALS, UVS, VERTICES, Gltf
from tests.meshfile.test_load import ASSETS, complaint, write


def load(folder: Path, file: Gltf) -> list[MeshPart]:
    return load_mesh(write(folder, "a.glb", file.glb()))


def png(color: tuple[int, int, int]) -> bytes:
    """A picture of one pixel."""
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", 1, 1, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(b"\0" + bytes(color)))
            + chunk(b"IEND", b""))


def test_transforms_of_nodes_are_applied_outwards(tmp_path: Path) -> None:
    """A matrix, column after column, over a translation × rotation × scale: 90° about +Z takes +X to +Y."""
    file = Gltf()
    child = file.node(mesh=file.mesh(NORMAL=file.accessor(NORMALS)), translation=[10, 0, 0], rotation=[0, 0, 0.5**0.5, 0.5**0.5], scale=[2, 3, 4])
    file.node(children=[child], matrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 100, 200, 300, 1])
    part, = load(tmp_path, file)
    x, y, z = VERTICES.astype(np.float64).T
    assert part.vertices == pytest.approx(np.stack([100 + 10 - 3 * y, 200 + 2 * x, 300 - 4 * z], axis=1))
    normals = np.stack([-NORMALS[:, 1] / 3, NORMALS[:, 0] / 2, -NORMALS[:, 2] / 4], axis=1)
    assert part.normals == pytest.approx(normals / np.linalg.norm(normals, axis=1, keepdims=True), abs=1e-7)
    assert np.array_equal(part.faces, FACES[:, ::-1])  # mirrored


def test_a_mesh_in_several_places(tmp_path: Path) -> None:
    file = Gltf()
    mesh = file.mesh()
    places = [file.node(mesh=mesh, translation=[x, 0, 0]) for x in (1, 2, 3)]
    file.node(mesh=file.mesh(), name="not in the scene")
    file.json |= {"scene": 0, "scenes": [{"nodes": places}]}
    assert [part.vertices[0, 0] for part in load(tmp_path, file)] == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(("mode", "indices", "expected"), [
    (5, [0, 1, 2, 3], [[0, 1, 2], [1, 3, 2]]), (6, [0, 1, 2, 3], [[1, 2, 0], [2, 3, 0]]), (4, [3, 1, 2], [[3, 1, 2]])])
def test_lists_strips_and_fans(tmp_path: Path, mode: int, indices: list[int], expected: list[list[int]]) -> None:
    file = Gltf()
    file.node(mesh=file.mesh(faces=np.array(indices), mode=mode))
    part, = load(tmp_path, file)
    assert part.faces.tolist() == expected


def test_points_and_lines_are_passed_over(tmp_path: Path) -> None:
    file = Gltf()
    for mode in (0, 1, 3, 4):
        file.node(mesh=file.mesh(VERTICES[:3], None, mode=mode))
    part, = load(tmp_path, file)
    assert part.faces.tolist() == [[0, 1, 2]]


def test_packed_numbers(tmp_path: Path) -> None:
    """Normalized integers, interleaved rows and exceptions (sparse)."""
    file = Gltf()
    rows = np.zeros(4, [("p", "<f4", 3), ("uv", "<u2", 2)])
    rows["p"], rows["uv"] = VERTICES, np.round(UVS * 65535)
    view = file.view(rows.tobytes(), byteStride=16)
    file.json["accessors"] += [{"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3"},
                               {"bufferView": view, "byteOffset": 12, "componentType": 5123, "count": 4, "type": "VEC2", "normalized": True}]
    colors = file.accessor(np.uint8([[0, 51, 255, 255]] * 4), normalized=True)
    normals = file.accessor(np.int8([[-128, 0, 0], [127, 0, 0], [0, 127, 0], [0, 0, 127]]), normalized=True)
    file.node(mesh=file.mesh(TEXCOORD_0=1, COLOR_0=colors, NORMAL=normals))
    file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 0
    file.json["accessors"][0]["sparse"] = {"count": 1, "indices": {"bufferView": file.view(b"\x02"), "componentType": 5121},
                                           "values": {"bufferView": file.view(np.float32([7, 8, 9]).tobytes())}}
    part, = load(tmp_path, file)
    assert part.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [7, 8, 9], [0, 0, 1]]
    assert part.uvs == pytest.approx(np.stack([UVS[:, 0], 1 - UVS[:, 1]], axis=1), abs=1e-4)
    assert part.colors == pytest.approx(np.tile([0, 0.2, 1.0], (4, 1)))
    assert part.normals.tolist() == [[-1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


def test_separate_and_embedded_buffers(tmp_path: Path) -> None:
    file = Gltf()
    file.node(mesh=file.mesh())
    file.json["buffers"] = [{"uri": "the%20data.bin", "byteLength": len(file.buffer)}]
    write(tmp_path, "the data.bin", file.buffer)
    part, = load_mesh(write(tmp_path, "a.gltf", json.dumps(file.json).encode()))
    assert np.array_equal(part.vertices, VERTICES)
    file.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(file.buffer).decode()
    part, = load_mesh(write(tmp_path, "b.gltf", json.dumps(file.json).encode()))
    assert np.array_equal(part.vertices, VERTICES)


def textured(file: Gltf, **info: Any) -> Gltf:
    """Adds a node with a textured material."""
    file.json |= {"images": [{"bufferView": file.view(png((10, 20, 30)))}], "textures": [{"source": 0}], "materials": [{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, **info}, "baseColorFactor": [0.5, 0.25, 0.125, 0.75], "metallicFactor": 0.5,
                                 "roughnessFactor": 0.25, "metallicRoughnessTexture": {"index": 0, **info}},
        "normalTexture": {"index": 0, **info}, "emissiveFactor": [0.5, 0.5, 1.0], "emissiveTexture": {"index": 0, **info},
        "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": True, "name": "all",
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}}}]}
    file.node(mesh=file.mesh(material=0, TEXCOORD_0=file.accessor(UVS), TEXCOORD_1=file.accessor(UVS[::-1].copy())))
    return file


def test_materials(tmp_path: Path) -> None:
    part, = load(tmp_path, textured(Gltf()))
    m = part.material
    assert (m.name, m.base_color, m.metallic, m.roughness, m.emission) == ("all", (0.5, 0.25, 0.125), 0.5, 0.25, (2.0, 2.0, 4.0))
    assert (m.opacity, m.alpha_mode, m.alpha_cutoff, m.double_sided) == (0.75, "mask", 0.25, True)
    assert m.base_color_image.dtype == np.uint8 and m.base_color_image.tolist() == [[[10, 20, 30]]]
    assert m.base_color_image is m.normal_image is m.metallic_roughness_image is m.emission_image
    part, = load_mesh(tmp_path / "a.glb", materials=False)
    assert part.material is None and part.uvs is not None


def test_a_primitive_without_material_keeps_its_uvs(tmp_path: Path) -> None:
    file = Gltf()
    file.node(mesh=file.mesh(TEXCOORD_0=file.accessor(UVS)))
    part, = load(tmp_path, file)
    assert part.material is None and np.array_equal(part.uvs[:, 0], UVS[:, 0])


def test_uv_sets_and_transforms(tmp_path: Path) -> None:
    """The extension's own example: the lower left quarter of the picture, turned clockwise by 90°."""
    part, = load(tmp_path, textured(Gltf(), texCoord=1))
    assert np.array_equal(part.uvs[:, 0], UVS[::-1, 0])
    transform = {"offset": [0, 1], "rotation": np.pi / 2, "scale": [0.5, 0.5]}
    part, = load(tmp_path, textured(Gltf(), extensions={"KHR_texture_transform": transform}))
    assert part.uvs == pytest.approx(np.stack([0.5 * UVS[:, 1], 0.5 * UVS[:, 0]], axis=1), abs=1e-12)


def edited(edit: str, file: Gltf | None = None) -> Gltf:
    """A file after a statement about its JSON, ``j``."""
    if file is None:
        file = Gltf()
        file.node(mesh=file.mesh())
    exec(edit, {"j": file.json, "file": file})
    return file


@pytest.mark.parametrize(("edit", "expected"), [
    ("j['asset']['version'] = '1.0'", "found glTF version 1.0, expected 2.0"),
    ("del j['asset']", "found broken glTF (KeyError: 'asset')"),
    ("j['extensionsRequired'] = ['KHR_draco_mesh_compression']", "found that it requires the extension KHR_draco_mesh_compression"),
    ("j['accessors'][0]['count'] = 5", "found 5 values that take 60 bytes of a view of 48, expected them to fit"),
    ("j['accessors'][0]['count'] = 10**12", "found 1000000000000 values that take"),
    ("j['accessors'][0]['count'] = -1", "found -1 for a count, expected an integer that is not negative"),
    ("j['accessors'][0]['count'] = '4'", "found '4' for a count"),
    ("del j['accessors'][0]['bufferView']", "found 4 values without bytes"),
    ("j['accessors'][0]['byteOffset'] = 4", "found 4 values that take 52 bytes of a view of 48"),
    ("j['accessors'][0]['type'] = 'VEC2'", "found POSITION of shape (4, 2), expected 3 numbers"),
    ("j['accessors'][0]['componentType'] = 7", "found broken glTF (KeyError: 7)"),
    ("j['bufferViews'][0]['byteLength'] = 10**15", "found a view of bytes 0 to 1000000000000000 of a buffer of"),
    ("j['bufferViews'][0]['byteStride'] = 2", "found 4 values that take"),
    ("j['bufferViews'][0]['buffer'] = 1", "found a reference to buffers[1], expected one of the file's 1"),
    ("j['buffers'][0]['byteLength'] = 1000", "found 72 bytes in a buffer of 1000"),
    ("j['buffers'][0]['uri'] = 'nothing.bin'", "found no file 'nothing.bin', which it names as a buffer"),
    ("j['buffers'][0]['uri'] = 'data:;base64,?'", "found a buffer that is not valid base64"),
    ("j['meshes'][0]['primitives'][0]['attributes']['POSITION'] = 9", "found a reference to accessors[9], expected one of the file's 2"),
    ("j['meshes'][0]['primitives'][0]['attributes']['POSITION'] = 'x'", "found a reference to accessors[x]"),
    ("j['meshes'][0]['primitives'][0]['material'] = 0", "found a reference to materials[0], expected one of the file's 0"),
    ("j['meshes'][0]['primitives'][0]['attributes']['NORMAL'] = 1", "found NORMAL of shape (12, 1), expected 3 numbers for each of 4 vertices"),
    ("j['accessors'][1]['count'] = 11", "found 11 indices in a list of triangles, expected a multiple of 3"),
    ("j['nodes'][0]['children'] = [0]", "found no triangle"),  # its own child: no root
    ("j['nodes'][0]['children'] = [0]; j['scenes'] = [{'nodes': [0]}]", "found nodes[0] in two places of the scene, expected a tree"),
    ("j['nodes'][0]['mesh'] = 1", "found a reference to meshes[1], expected one of the file's 1"),
    ("j['nodes'][0]['mesh'] = [1]", "found broken glTF (TypeError"),
    ("j['nodes'][0]['scale'] = [1, 2]", "found broken glTF (ValueError"),
    ("j['nodes'][0]['translation'] = [1e308 * 10, 0, 0]", "found a node's transform that is not finite"),
    ("j['meshes'] = {}", "found "), ("j['nodes'] = 3", "found broken glTF"),
    ("j['accessors'][1]['componentType'] = 5121; j['accessors'][1]['sparse'] = {'count': 1, 'indices': {'bufferView': 1, 'componentType': 5123, "
     "'byteOffset': 10}, 'values': {'bufferView': 1}}; j['accessors'][1]['count'] = 3", "found an exception for value 3 of 3"),
])
def test_lying_gltf(tmp_path: Path, edit: str, expected: str) -> None:
    assert complaint(write(tmp_path, "a.glb", edited(edit).glb())).startswith(expected)


@pytest.mark.parametrize(("edit", "expected"), [
    ("j['images'][0] = {'uri': 'a%20b.png'}", "found no file 'a b.png', which it names as picture 0"),
    ("j['images'][0]['bufferView'] = 99", "found a reference to bufferViews[99]"),
    ("j['bufferViews'][0]['byteLength'] = 50", "found picture 0 of 50 bytes that cannot be decoded"),
    ("j['images'][0]['bufferView'] = 1", "found picture 0 that is neither PNG, JPEG nor WebP"),
    ("j['textures'][0]['source'] = 3", "found a reference to images[3], expected one of the file's 1"),
    ("del j['textures'][0]['source']", "found a reference to images[None]"),
    ("j['materials'][0]['normalTexture']['texCoord'] = 1", "found pictures of material 'all' on different uv sets or transforms"),
    ("j['materials'][0]['alphaMode'] = 'SOLID'", "found alphaMode 'SOLID', expected OPAQUE, BLEND or MASK"),
    ("j['materials'][0]['emissiveFactor'] = [1, 2]", "found [4.0, 8.0], expected 3 numbers"),
    ("j['materials'][0]['pbrMetallicRoughness']['baseColorFactor'] = [1, 1, 1]", "found [1, 1, 1], expected 4 numbers"),
])
def test_lying_materials(tmp_path: Path, edit: str, expected: str) -> None:
    path = write(tmp_path, "a.glb", edited(edit, textured(Gltf())).glb())
    assert complaint(path).startswith(expected)
    assert load_mesh(path, materials=False)[0].material is None


def test_lengths_of_a_glb(tmp_path: Path) -> None:
    file = Gltf()
    file.node(mesh=file.mesh())
    whole = file.glb()
    assert complaint(write(tmp_path, "a.glb", whole[:-1])).startswith(f"found {len(whole) - 1} bytes of a file of {len(whole)}")
    assert complaint(write(tmp_path, "a.glb", file.glb(length=40))).startswith("found a chunk of")
    assert complaint(write(tmp_path, "a.glb", whole[:4] + b"\1\0\0\0" + whole[8:])).startswith("found GLB version 1, expected 2")
    assert complaint(write(tmp_path, "a.glb", whole.replace(b"JSON", b"XXXX"))).startswith("found a GLB without a JSON chunk")
    assert complaint(write(tmp_path, "a.gltf", b"{")).startswith("found broken glTF (JSONDecodeError")
    assert complaint(write(tmp_path, "a.gltf", b"[" * 100_000)).startswith("found broken glTF (RecursionError")


@pytest.mark.parametrize("name", ["alien.glb", "alpha_blend_mode.glb", "flight_helmet/FlightHelmet.gltf", "spot_valley.glb"])
def test_trimesh_reads_the_same_geometry(name: str) -> None:
    trimesh = pytest.importorskip("trimesh")
    if not (ASSETS / name).is_file():
        pytest.skip(f"{name} is not here")
    scene = trimesh.load_scene(ASSETS / name, process=False)
    theirs = []
    for node in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        theirs.append((mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3], np.asarray(mesh.faces), getattr(mesh.visual, "uv", None)))
    ours = load_mesh(ASSETS / name, materials=False)
    assert len(ours) == len(theirs)
    for part in ours:
        match = [i for i, (vertices, faces, _) in enumerate(theirs) if vertices.shape == part.vertices.shape and np.allclose(vertices, part.vertices,
                 rtol=0, atol=1e-12 * np.abs(vertices).max()) and np.array_equal(faces, part.faces)]
        assert match
        uv = theirs[match[0]][2]
        assert uv is None or np.allclose(uv, part.uvs, rtol=0, atol=1e-6)


def test_every_type_where_json_expects_another(tmp_path: Path) -> None:
    """Each value of a whole file replaced by each of some others: it is read or refused, never a traceback."""
    file = textured(Gltf())
    file.glb()
    places: list[tuple[Any, Any]] = []
    waiting: list[Any] = [file.json]
    while waiting:
        here = waiting.pop()
        for key, value in here.items() if isinstance(here, dict) else enumerate(here):
            places.append((here, key))
            waiting += [value] if isinstance(value, (dict, list)) else []
    refused = 0
    for (holder, key), other in itertools.product(places, (None, -1, 2**40, "x", [], {}, True, 0.5)):
        kept, holder[key] = holder[key], other
        path = write(tmp_path, "a.glb", file.pack())
        holder[key] = kept
        try:
            load_mesh(path)
        except SceneError as error:
            refused += 1
            assert "\n" not in str(error)
    assert refused > len(places)
