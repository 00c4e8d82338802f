"""Mesh files of every format: what is read, and how what is wrong is said."""

from __future__ import annotations

import logging
import warnings
from pathlib import Path

import numpy as np
import pytest

from lumiere.errors import SceneError
from lumiere.meshfile import clean, load_mesh
from tests.meshfile import samples
from tests.meshfile.samples import COLORS, FACES, NORMALS, SAMPLES, UVS, VERTICES

ASSETS = Path(__file__).parents[3] / "shared" / "assets"


def write(folder: Path, name: str, data: bytes) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


def complaint(path: Path) -> str:
    """What loading ``path`` complains of, without the path; it is one line."""
    with pytest.raises(SceneError) as caught:
        load_mesh(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: found ") and "\n" not in text
    return text[len(f"{path}: ") :]


@pytest.mark.parametrize("name", SAMPLES)
def test_every_format_gives_the_same_triangles(tmp_path: Path, name: str) -> None:
    part, = load_mesh(write(tmp_path, name, SAMPLES[name]))
    assert part.vertices.dtype == np.float64 and part.faces.dtype.kind == "i"
    triangles = part.vertices[part.faces].reshape(4, 9)
    assert sorted(map(tuple, triangles)) == sorted(map(tuple, VERTICES[FACES].reshape(4, 9).astype(np.float64)))
    assert clean(part.vertices, part.faces)[1] == {}


@pytest.mark.parametrize("name", ["binary.ply", "ascii.ply", "mesh.obj", "mesh.glb"])
def test_what_vertices_carry(tmp_path: Path, name: str) -> None:
    part, = load_mesh(write(tmp_path, name, SAMPLES[name]))
    of = [int(np.flatnonzero((VERTICES == v).all(axis=1))[0]) for v in part.vertices]
    assert np.array_equal(part.normals, NORMALS[of].astype(np.float64))
    v = 1.0 - UVS[of, 1] if name == "mesh.glb" else UVS[of, 1]  # glTF counts v from the top
    assert np.array_equal(part.uvs, np.stack([UVS[of, 0], v], axis=1).astype(np.float64))
    if name.endswith("ply"):
        assert part.colors[of.index(0)].tolist() == [1.0, 0.0, 0.0]
        assert part.colors[of.index(3)] == pytest.approx(((128 / 255 + 0.055) / 1.055) ** 2.4)
        assert len(COLORS) == len(part.colors)


@pytest.mark.parametrize("name", ["binary.stl", "ascii.stl", "mesh.off"])
def test_normals_are_not_made_up(tmp_path: Path, name: str) -> None:
    part, = load_mesh(write(tmp_path, name, SAMPLES[name]))
    assert part.normals is None and part.uvs is None and part.colors is None and part.material is None


def test_quadrilaterals_are_split(tmp_path: Path) -> None:
    for name, data in (("a.ply", samples.ply(faces=np.int32([[0, 1, 2, 3]]))), ("a.obj", samples.obj("f 1 2 3 4")),
                       ("b.ply", samples.ply("ascii", faces=np.int32([[0, 1, 2, 3]])))):
        part, = load_mesh(write(tmp_path, name, data))
        assert len(part.faces) == 2 and set(part.faces.ravel()) == {0, 1, 2, 3}


def test_uvs_at_the_corners_of_ply_faces(tmp_path: Path) -> None:
    """A vertex that has two places in the picture becomes two."""
    header = ("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
              "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n")
    body = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2 6 0 0 1 0 0 1\n3 0 2 3 6 0.5 0.5 0 1 1 1\n"
    part, = load_mesh(write(tmp_path, "a.ply", (header + body).encode()))
    corners = np.concatenate([part.vertices, part.uvs], axis=1)[part.faces].reshape(2, 3, 5).tolist()
    assert corners == [[[0, 0, 0, 0, 0], [1, 0, 0, 1, 0], [0, 1, 0, 0, 1]], [[0, 0, 0, 0.5, 0.5], [0, 1, 0, 0, 1], [0, 0, 1, 1, 1]]]


@pytest.mark.parametrize(("name", "data", "expected"), [
    ("a.ply", b"", "found no PLY header"),
    ("a.ply", samples.ply()[:-1], "found a broken PLY file"),
    ("a.ply", samples.ply() + b"x", "found a broken PLY file"),
    ("a.ply", samples.ply(face_count=4_000_000_000), "found 4000000004 rows of data promised by a file that holds at most"),
    ("a.ply", samples.ply(vertex_count=-1), "found 3 rows of data promised"),
    ("a.ply", samples.ply("ascii", face_count=5), "found 9 rows of data promised by a file that holds at most 8"),
    ("a.ply", samples.ply(face_count=0), "found "),
    ("a.ply", samples.ply("ascii").replace(b"1.0 0.0 0.0", b"1.0 zero 0.0", 1), "found a broken PLY file"),
    ("a.ply", samples.ply(faces=np.int32([[0, 1, 4]])), "found a broken PLY file"),
    ("a.ply", samples.ply(faces=np.int32([[0, 1, -1]])), "found a"),
    ("a.ply", samples.ply(faces=np.int32([[0, 1, 4]]), carried=False), "found a face with vertex 4, expected one of the 4 vertices, 0 to 3"),
    ("a.ply", samples.ply(faces=np.int32([[0, 1, -1]]), carried=False), "found a face with vertex -1"),
    ("a.ply", samples.ply()[:-13] + b"\x02" + samples.ply()[-12:], "found faces with different numbers of vertices"),
    ("a.stl", b"", "found no triangle, expected at least one"),
    ("a.stl", samples.stl()[:-1], "found 283 bytes and 4 triangles promised, which take 284"),
    ("a.stl", samples.stl(3_000_000_000), "found 284 bytes and 3000000000 triangles promised"),
    ("a.stl", samples.stl_ascii()[:-80], "found an ASCII file that does not end with 'endsolid'"),
    ("a.stl", samples.stl_ascii().replace(b"vertex 1.0 0.0 0.0", b"vertex 1.0 0.0", 1), "found a broken STL file"),
    ("a.obj", b"", "found "), ("a.obj", b"# nothing\n", "found "),
    ("a.obj", samples.obj("f 1 2 0"), "found a face with the index 0, expected indices from 1"),
    ("a.obj", samples.obj("f 1/1/1 2/2/2 3/0/3"), "found a face with the index 0"),
    ("a.obj", samples.obj("f 1 2 5"), "found a"), ("a.obj", samples.obj("f 1/1/1 2/2/2 3/5/3"), "found a broken OBJ file"),
    ("a.obj", samples.obj("f 1//1 2//2 3//9"), "found a broken OBJ file"),
    ("a.obj", samples.obj("f 1 2"), "found no triangle"), ("a.obj", samples.obj("f 1 2 3\nf 1 2"), "found a broken OBJ file"),
    ("a.obj", samples.obj("f 1 2 three"), "found a broken OBJ file"),
    ("a.obj", samples.obj("f -4 -3 -2\nv 5 5 5"), "found indices relative to vertices that are followed by more"),
    ("a.obj", b"v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", "found vertices of shape (3, 2), expected (3, 3)"),
    ("a.off", b"OFF\n", "found no counts"), ("a.off", samples.off()[:-20], "found fewer whole rows than the 4 vertices and 4 faces promised"),
    ("a.off", samples.off().replace(b"4 4 6", b"4000000000 4 6"), "found fewer whole rows than the 4000000000 vertices"),
    ("a.off", samples.off().replace(b"3 0 2 1", b"3 0 2"), "found fewer whole rows"),
    ("a.off", samples.off().replace(b"3 0 2 1", b"3 0 2 9"), "found a broken OFF file"),
    ("a.glb", b"", "found no GLB header"),
    ("a.plx", b"ply", "found a file of type 'plx', expected one of glb, gltf, obj, off, ply, stl; did you mean ply?"),
    ("a", b"ply", "found a file of type ''"), ("a.zip", b"PK", "found a file of type 'zip'"),
])
def test_lying_files(tmp_path: Path, name: str, data: bytes, expected: str) -> None:
    assert complaint(write(tmp_path, name, data)).startswith(expected)


def test_latin_1_in_names_and_comments(tmp_path: Path) -> None:
    for name, data in (("a.obj", b"# caf\xe9\n" + samples.obj()), ("a.off", samples.off().replace(b"OFF\n", b"OFF\n# caf\xe9\n")),
                       ("a.stl", samples.stl_ascii().replace(b"tetrahedron", b"caf\xe9")),
                       ("a.ply", samples.ply().replace(b"element", b"comment caf\xe9\nelement", 1)),
                       ("b.ply", samples.ply("ascii").replace(b"element", b"comment caf\xe9\nelement", 1))):
        assert len(load_mesh(write(tmp_path, name, data))[0].faces) == 4


def test_a_missing_file(tmp_path: Path) -> None:
    for name in ("a.ply", "a.obj", "a.stl", "a.off", "a.glb", "a.gltf"):
        assert complaint(tmp_path / name).startswith("found that it cannot be read (No such file or directory)")


@pytest.mark.parametrize("name", SAMPLES)
def test_damaged_files_are_read_or_refused_in_silence(tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str) -> None:
    """Cut anywhere, or with bytes changed: whatever comes of it has valid faces, or is one line."""
    data = SAMPLES[name]
    random = np.random.default_rng(len(data))
    cuts = [data[:n] for n in range(0, len(data), max(1, len(data) // 60))]
    changed = []
    for _ in range(150):
        mutant = bytearray(data)
        for place in random.integers(len(data), size=random.integers(1, 4)):
            mutant[place] = random.integers(256)
        changed.append(bytes(mutant))
    refused = 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for mutant in cuts + changed:
            path = write(tmp_path, name, mutant)
            try:
                for part in load_mesh(path):
                    assert part.faces.shape[1] == 3 and part.faces.min() >= 0 and part.faces.max() < len(part.vertices)
                    assert all(a is None or len(a) == len(part.vertices) for a in (part.normals, part.uvs, part.colors))
                    clean(part.vertices, part.faces)
            except SceneError as error:
                assert "\n" not in str(error) and str(error).startswith(f"{path}: found ")
                refused += 1
    assert capfd.readouterr() == ("", "")
    assert refused >= (len(cuts) if name in ("binary.ply", "binary.stl", "mesh.glb") else 20)


def test_trimesh_keeps_its_voice_outside(tmp_path: Path) -> None:
    log = logging.getLogger("trimesh")
    before = list(log.handlers), log.propagate, log.level
    load_mesh(write(tmp_path, "a.ply", SAMPLES["binary.ply"]))
    assert (list(log.handlers), log.propagate, log.level) == before


@pytest.mark.parametrize(("name", "parts", "faces"), [
    ("alien.glb", 18, 292), ("alpha_blend_mode.glb", 9, 61), ("flight_helmet/FlightHelmet.gltf", 6, 94_722), ("fuze/fuze.obj", 1, 1000),
    ("spot/spot.obj", 1, 5856), ("spot_closed.ply", 1, 5856), ("spot_valley.glb", 2, 656_034), ("broken/degenerate.ply", 1, 5878),
    ("broken/nan_inf.ply", 1, 5856), ("broken/soup.stl", 1, 100)])
def test_assets(name: str, parts: int, faces: int) -> None:
    if not (ASSETS / name).is_file():
        pytest.skip(f"{name} is not here")
    loaded = load_mesh(ASSETS / name)
    assert (len(loaded), sum(len(part.faces) for part in loaded)) == (parts, faces)


class TestMaterials:
    """OBJ's and PLY's."""

    def test_mtl(self, tmp_path: Path) -> None:
        write(tmp_path, "a picture.png", b"")
        write(tmp_path, "b.mtl", b"# c\nnewmtl one\nKd 0.1 0.2 0.3\nmap_Kd -s 1 1 1 -clamp on a picture.png\nKe 2 2 2\nPm 1\nPr 0.25\nd 0.5\nTr 1\n"
                                 b"newmtl\ttwo\t\nKd 0.5\nKs 1 1 1\nNs 30\n")
        mesh = samples.obj("usemtl one\nf 1 2 3\nusemtl two\nf 1 2 4\nusemtl three\nf 1 3 4")
        parts = load_mesh(write(tmp_path, "a.obj", b"mtllib b.mtl\n" + mesh))
        by_name = {part.material.name if part.material else None: part for part in parts}
        assert set(by_name) == {"one", "two", None}
        one, two = by_name["one"].material, by_name["two"].material
        assert one.base_color == (0.1, 0.2, 0.3) and one.base_color_image == tmp_path / "a picture.png"
        assert (one.emission, one.metallic, one.roughness, one.opacity, one.alpha_mode) == ((2, 2, 2), 1, 0.25, 0.5, "blend")
        assert two.base_color == (0.5, 0.5, 0.5) and two.opacity == 1.0
        assert two.roughness**4 == pytest.approx(2 / 32)  # α² of an exponent of 30

    @pytest.mark.parametrize(("mtl", "expected"), [
        (None, "found no file 'b.mtl', which it names as its material library"),
        (b"newmtl one\nmap_Kd c.png\n", "found no file 'c.png', which it names as its picture map_kd of material 'one'"),
        (b"newmtl one\nKd red\n", "found 'Kd red' in b.mtl, expected numbers after kd"),
        (b"newmtl one\nPr nan\n", "found 'Pr nan' in b.mtl"), (b"newmtl one\nKd \n", "found 'Kd' in b.mtl")])
    def test_mtl_that_is_wrong(self, tmp_path: Path, mtl: bytes | None, expected: str) -> None:
        if mtl is not None:
            write(tmp_path, "b.mtl", mtl)
        path = write(tmp_path, "a.obj", b"mtllib b.mtl\n" + samples.obj("usemtl one\nf 1 2 3"))
        assert complaint(path).startswith(expected)
        part, = load_mesh(path, materials=False)
        assert part.material is None and len(part.faces) == 1

    def test_the_texture_of_a_ply(self, tmp_path: Path) -> None:
        data = samples.ply().replace(b"element vertex", b"comment TextureFile d.png\nelement vertex", 1)
        path = write(tmp_path, "a.ply", data)
        assert complaint(path).startswith("found no file 'd.png', which it names as its texture")
        write(tmp_path, "d.png", b"")
        assert load_mesh(path)[0].material.base_color_image == tmp_path / "d.png"
        assert load_mesh(path, materials=False)[0].material is None
