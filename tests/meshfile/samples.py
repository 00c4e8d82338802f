"""Small mesh files, written here byte by byte."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

VERTICES = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
FACES = np.int32([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
NORMALS = np.float32([[-0.6, -0.48, -0.64], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
UVS = np.float32([[0, 0], [1, 0], [0.25, 1], [0.5, 0.5]])
COLORS = np.uint8([[255, 0, 0], [0, 255, 0], [0, 0, 255], [128, 128, 128]])


def ply(encoding: str = "binary_little_endian", *, faces: np.ndarray = FACES, vertex_count: int | None = None, face_count: int | None = None,
        carried: bool = True) -> bytes:
    """A tetrahedron, with normals, uv and colours where ``carried``; the counts may lie."""
    properties = ["float x", "float y", "float z"]
    fields: list[Any] = [("p", "<f4", 3)]
    if carried:
        properties += ["float nx", "float ny", "float nz", "uchar red", "uchar green", "uchar blue", "float s", "float t"]
        fields += [("n", "<f4", 3), ("c", "u1", 3), ("uv", "<f4", 2)]
    vertices = np.zeros(len(VERTICES), fields)
    vertices["p"] = VERTICES
    if carried:
        vertices["n"], vertices["c"], vertices["uv"] = NORMALS, COLORS, UVS
    lists = np.zeros(len(faces), [("n", "u1"), ("i", "<i4", faces.shape[1])])
    lists["n"], lists["i"] = faces.shape[1], faces
    header = [f"ply\nformat {encoding} 1.0\nelement vertex {len(VERTICES) if vertex_count is None else vertex_count}"]
    header += [f"property {p}" for p in properties]
    header += [f"element face {len(faces) if face_count is None else face_count}", "property list uchar int vertex_indices", "end_header\n"]
    if encoding == "ascii":
        rows = [" ".join(str(x) for field in row for x in np.ravel(field).tolist()) for table in (vertices, lists) for row in table]
        return ("\n".join(header) + "\n".join(rows) + "\n").encode()
    return "\n".join(header).encode() + vertices.tobytes() + lists.tobytes()


def stl(count: int | None = None) -> bytes:
    """A binary STL."""
    triangles = np.zeros(len(FACES), [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    triangles["v"] = VERTICES[FACES]
    return b"made by hand".ljust(80) + struct.pack("<I", len(FACES) if count is None else count) + triangles.tobytes()


def stl_ascii() -> bytes:
    facets = []
    for face in FACES:
        corners = "\n".join("vertex " + " ".join(map(str, VERTICES[i])) for i in face)
        facets.append(f"facet normal 0 0 0\nouter loop\n{corners}\nendloop\nendfacet")
    return ("solid tetrahedron\n" + "\n".join(facets) + "\nendsolid tetrahedron\n").encode()


def obj(faces: str | None = None) -> bytes:
    lines = [f"v {x} {y} {z}" for x, y, z in VERTICES] + [f"vt {u} {v}" for u, v in UVS] + [f"vn {x} {y} {z}" for x, y, z in NORMALS]
    lines.append("\n".join("f " + " ".join(f"{i + 1}/{i + 1}/{i + 1}" for i in face) for face in FACES) if faces is None else faces)
    return ("\n".join(lines) + "\n").encode()


def off() -> bytes:
    rows = [" ".join(map(str, v)) for v in VERTICES] + ["3 " + " ".join(map(str, f)) for f in FACES]
    return (f"OFF\n{len(VERTICES)} {len(FACES)} 6\n" + "\n".join(rows) + "\n").encode()


COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}


class Gltf:
    """A glTF file in the making: one buffer, to which arrays are added."""

    def __init__(self) -> None:
        self.buffer = b""
        self.json: dict[str, Any] = {"asset": {"version": "2.0"}, "buffers": [{}], "bufferViews": [], "accessors": [], "meshes": [], "nodes": []}

    def view(self, data: bytes, **more: Any) -> int:
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data), **more})
        self.buffer += data + bytes(-len(data) % 4)
        return len(self.json["bufferViews"]) - 1

    def accessor(self, array: np.ndarray, **more: Any) -> int:
        kind = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}[1 if array.ndim == 1 else array.shape[1]]
        self.json["accessors"].append({"bufferView": self.view(array.tobytes()), "componentType": COMPONENTS[array.dtype.str[1:]],
                                       "count": len(array), "type": kind, **more})
        return len(self.json["accessors"]) - 1

    def mesh(self, vertices: np.ndarray = VERTICES, faces: np.ndarray | None = FACES, **more: Any) -> int:
        """A mesh of one primitive; ``more`` has further attributes, and ``mode`` and ``material``."""
        primitive = {"attributes": {"POSITION": self.accessor(vertices)}}
        primitive |= {key: more.pop(key) for key in ("mode", "material") if key in more}
        primitive["attributes"] |= more
        if faces is not None:
            primitive["indices"] = self.accessor(faces.ravel().astype(np.uint16))
        self.json["meshes"].append({"primitives": [primitive]})
        return len(self.json["meshes"]) - 1

    def node(self, **node: Any) -> int:
        self.json["nodes"].append(node)
        return len(self.json["nodes"]) - 1

    def glb(self, *, length: int | None = None) -> bytes:
        self.json["buffers"][0].setdefault("byteLength", len(self.buffer))
        return self.pack(length=length)

    def pack(self, *, length: int | None = None) -> bytes:
        """The file of the JSON as it is."""
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<2I", len(text), 0x4E4F534A) + text + struct.pack("<2I", len(self.buffer), 0x004E4942) + self.buffer
        return b"glTF" + struct.pack("<2I", 2, 12 + len(chunks) if length is None else length) + chunks


def glb() -> bytes:
    """A tetrahedron with normals, uv and a material."""
    file = Gltf()
    file.json["materials"] = [{"name": "paint", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 1]}}]
    file.node(mesh=file.mesh(NORMAL=file.accessor(NORMALS), TEXCOORD_0=file.accessor(UVS), material=0))
    return file.glb()


SAMPLES = {"binary.ply": ply(), "ascii.ply": ply("ascii"), "binary.stl": stl(), "ascii.stl": stl_ascii(), "mesh.obj": obj(), "mesh.off": off(),
           "mesh.glb": glb()}
"""The same tetrahedron in every format."""
