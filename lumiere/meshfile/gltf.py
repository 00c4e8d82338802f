"""glTF 2.0 and GLB (Khronos 2021): geometry in world space. Every number in the file is checked before it is believed."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from lumiere.meshfile.part import MeshFileError, MeshPart, place

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
TRIANGLES, STRIP, FAN = 4, 5, 6
SUPPORTED = ("KHR_mesh_quantization", "KHR_texture_transform", "KHR_materials_")
"""Beginnings of the extensions that a file may require. What only changes a material's look may be left out."""

JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942


def read_gltf(path: Path, materials: bool) -> list[MeshPart]:
    """One part for each primitive of each node that has a mesh, in the order of the nodes. Raises MeshFileError."""
    from lumiere.meshfile.gltf_material import Materials

    try:
        document = Document(path)
        of_materials = Materials(document) if materials else None
        primitives: dict[int, list[MeshPart]] = {}
        parts = []
        for matrix, node in _nodes(document):
            mesh = node["mesh"]
            if mesh not in primitives:
                primitives[mesh] = list(_primitives(document, mesh, of_materials))
            parts += [place(part, matrix) for part in primitives[mesh]]
        return parts
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError) as error:
        raise MeshFileError(f"found broken glTF ({type(error).__name__}: {error}), expected a valid file; export it again") from None


class Document:
    """A file's JSON, and the bytes that it speaks of."""

    def __init__(self, path: Path) -> None:
        self.folder = path.parent
        data = path.read_bytes()
        text, self.chunk = _chunks(data) if data[:4] == b"glTF" or path.suffix.lower() == ".glb" else (data, None)
        self.json: dict[str, Any] = json.loads(text.decode("utf-8-sig"))
        version = str(self.json["asset"]["version"])
        if version.split(".")[0] != "2":
            raise MeshFileError(f"found glTF version {version}, expected 2.0")
        for name in self.json.get("extensionsRequired", []):
            if not name.startswith(SUPPORTED):
                raise MeshFileError(f"found that it requires the extension {name}, which cannot be read; export it without")
        self._buffers: dict[int, bytes] = {}
        self._accessors: dict[int, np.ndarray] = {}

    def item(self, kind: str, index: Any) -> dict[str, Any]:
        """Entry ``index`` of the array ``kind``."""
        items = self.json.get(kind, [])
        if not (isinstance(index, int) and 0 <= index < len(items)):
            raise MeshFileError(f"found a reference to {kind}[{index}], expected one of the file's {len(items)}")
        return items[index]

    def resource(self, uri: str, what: str) -> Path | bytes:
        """A file beside this one, or the bytes inside the address."""
        if uri.startswith("data:"):
            try:
                return base64.b64decode(uri.partition(",")[2], validate=True)
            except binascii.Error:
                raise MeshFileError(f"found {what} that is not valid base64, expected its bytes; export it again") from None
        path = self.folder / unquote(uri)
        if not path.is_file():
            raise MeshFileError(f"found no file {unquote(uri)!r}, which it names as {what}; put it where it belongs")
        return path

    def _buffer(self, index: int) -> bytes:
        if index not in self._buffers:
            buffer = self.item("buffers", index)
            if "uri" in buffer:
                resource = self.resource(buffer["uri"], "a buffer")
                data = resource.read_bytes() if isinstance(resource, Path) else resource
            elif self.chunk is not None:
                data = self.chunk
            else:
                raise MeshFileError("found a buffer without bytes, expected a uri or a binary chunk")
            if len(data) < _natural(buffer["byteLength"], "a buffer's length"):
                raise MeshFileError(f"found {len(data)} bytes in a buffer of {buffer['byteLength']}, expected all of them; the file may be cut off")
            self._buffers[index] = data
        return self._buffers[index]

    def view(self, index: Any) -> tuple[memoryview, int]:
        """The bytes of a buffer view, and its stride (0: none given)."""
        view = self.item("bufferViews", index)
        data = self._buffer(view["buffer"])
        begin, length = _natural(view.get("byteOffset", 0), "an offset"), _natural(view["byteLength"], "a view's length")
        if begin + length > len(data):
            raise MeshFileError(f"found a view of bytes {begin} to {begin + length} of a buffer of {len(data)}, expected it to lie within")
        return memoryview(data)[begin : begin + length], _natural(view.get("byteStride", 0), "a stride")

    def accessor(self, index: Any) -> np.ndarray:
        """(count, width) array: integers as they are or, where the file says normalized, as float64 in [-1, 1]."""
        accessor = self.item("accessors", index)
        if index in self._accessors:
            return self._accessors[index]
        count, width = _natural(accessor["count"], "a count"), WIDTHS[accessor["type"]]
        dtype = np.dtype(COMPONENTS[accessor["componentType"]])
        if "bufferView" in accessor:
            values = self._read(accessor["bufferView"], accessor.get("byteOffset", 0), count, width, dtype)
        elif "sparse" in accessor and count < 1 << 28:
            values = np.zeros((count, width), dtype)
        else:
            raise MeshFileError(f"found {count} values without bytes, expected a buffer view; if the file is compressed, export it without")
        if "sparse" in accessor:
            values = self._with_exceptions(values, accessor["sparse"])
        if accessor.get("normalized") and dtype.kind != "f":
            values = np.maximum(values / np.iinfo(dtype).max, -1.0)
        self._accessors[index] = values
        return values

    def _read(self, view: Any, offset: Any, count: int, width: int, dtype: np.dtype) -> np.ndarray:
        data, stride = self.view(view)
        size = width * dtype.itemsize
        stride, offset = stride or size, _natural(offset, "an offset")
        end = offset + (count - 1) * stride + size if count else offset
        if end > len(data) or stride < size:
            raise MeshFileError(f"found {count} values that take {end} bytes of a view of {len(data)}, expected them to fit; the file may be cut off")
        return np.ndarray((count, width), dtype, data, offset, (stride, dtype.itemsize))

    def _with_exceptions(self, values: np.ndarray, sparse: dict[str, Any]) -> np.ndarray:
        count, indices, replacements = _natural(sparse["count"], "a count"), sparse["indices"], sparse["values"]
        rows = self._read(indices["bufferView"], indices.get("byteOffset", 0), count, 1, np.dtype(COMPONENTS[indices["componentType"]]))
        if count and rows.max() >= len(values):
            raise MeshFileError(f"found an exception for value {rows.max()} of {len(values)}, expected one of them")
        values = values.copy()
        values[rows[:, 0]] = self._read(replacements["bufferView"], replacements.get("byteOffset", 0), count, values.shape[1], values.dtype)
        return values

    @property
    def roots(self) -> list[int]:
        """The nodes that the file's scene begins with; all that are no other's children where it has no scene."""
        if self.json.get("scenes"):
            return self.item("scenes", self.json.get("scene", 0)).get("nodes", [])
        nodes = self.json.get("nodes", [])
        children = {child for node in nodes for child in node.get("children", [])}
        return [i for i in range(len(nodes)) if i not in children]


def _natural(value: Any, what: str) -> int:
    if not isinstance(value, int) or value < 0:
        raise MeshFileError(f"found {value!r} for {what}, expected an integer that is not negative")
    return value


def _chunks(data: bytes) -> tuple[bytes, bytes | None]:
    """The JSON text and the binary chunk of a GLB."""
    if data[:4] != b"glTF" or len(data) < 20:
        raise MeshFileError("found no GLB header, expected a binary glTF file")
    version, length = struct.unpack_from("<2I", data, 4)
    if version != 2:
        raise MeshFileError(f"found GLB version {version}, expected 2")
    if length > len(data):
        raise MeshFileError(f"found {len(data)} bytes of a file of {length}, expected all of them; it is cut off")
    chunks: dict[int, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<2I", data, place)
        place += 8
        if place + size > length:
            raise MeshFileError(f"found a chunk of {size} bytes where the file has {length - place}, expected it to fit")
        chunks.setdefault(kind, data[place : place + size])
        place += size
    if JSON_CHUNK not in chunks:
        raise MeshFileError("found a GLB without a JSON chunk, expected one")
    return chunks[JSON_CHUNK], chunks.get(BINARY_CHUNK)


def _nodes(document: Document) -> Iterator[tuple[np.ndarray, dict[str, Any]]]:
    """The nodes of the scene that have a mesh, with their (4, 4) matrices to world space."""
    seen = set()
    waiting = [(root, np.eye(4)) for root in reversed(document.roots)]
    while waiting:
        index, to_world = waiting.pop()
        node = document.item("nodes", index)
        if index in seen:
            raise MeshFileError(f"found nodes[{index}] in two places of the scene, expected a tree")
        seen.add(index)
        to_world = to_world @ _matrix(node)
        if "mesh" in node:
            yield to_world, node
        waiting += [(child, to_world) for child in reversed(node.get("children", []))]


def _matrix(node: dict[str, Any]) -> np.ndarray:
    """A node's (4, 4) matrix: given, column after column, or translation × rotation × scale."""
    if "matrix" in node:
        matrix = np.array(node["matrix"], np.float64).reshape(4, 4).T
    else:
        x, y, z, w = np.array(node.get("rotation", [0, 0, 0, 1]), np.float64)
        norm = x * x + y * y + z * z + w * w
        s = 2.0 / norm if norm > 0 else 0.0
        rotation = np.array([[1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
                             [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
                             [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)]])
        matrix = np.eye(4)
        matrix[:3, :3] = rotation * np.array(node.get("scale", [1, 1, 1]), np.float64).reshape(3)
        matrix[:3, 3] = np.array(node.get("translation", [0, 0, 0]), np.float64)
    if not np.isfinite(matrix).all():
        raise MeshFileError("found a node's transform that is not finite, expected numbers")
    return matrix


def _primitives(document: Document, index: Any, materials: Any) -> Iterator[MeshPart]:
    """The triangles of a mesh, in its own space."""
    for primitive in document.item("meshes", index)["primitives"]:
        mode = primitive.get("mode", TRIANGLES)
        attributes = primitive["attributes"]
        if mode not in (TRIANGLES, STRIP, FAN) or "POSITION" not in attributes:
            continue
        vertices = _attribute(document, attributes, "POSITION", 3, None)
        count = len(vertices)
        if "indices" in primitive:
            indices = document.accessor(primitive["indices"])[:, 0].astype(np.int64)
        else:
            indices = np.arange(count)
        normals = _attribute(document, attributes, "NORMAL", 3, count) if "NORMAL" in attributes else None
        colors = _attribute(document, attributes, "COLOR_0", None, count)[:, :3] if "COLOR_0" in attributes else None
        material, mapping = materials.of(primitive.get("material")) if materials is not None else (None, None)
        uv_name = f"TEXCOORD_{mapping.uv_set if mapping else 0}"
        uvs = _attribute(document, attributes, uv_name, 2, count) if uv_name in attributes else None
        if uvs is not None:
            uvs = mapping.apply(uvs) if mapping else uvs
            uvs = np.stack([uvs[:, 0], 1.0 - uvs[:, 1]], axis=1)  # glTF's (0, 0) is the picture's top left
        yield MeshPart(vertices, _faces(indices, mode), normals, uvs, colors, material)


def _attribute(document: Document, attributes: dict[str, Any], name: str, width: int | None, count: int | None) -> np.ndarray:
    values = document.accessor(attributes[name])
    if values.shape[1] != (width or max(values.shape[1], 3)) or (count is not None and len(values) != count):
        raise MeshFileError(f"found {name} of shape {values.shape}, expected {width or '3 or 4'} numbers for each of "
                          f"{'the' if count is None else count} vertices")
    return values.astype(np.float64)


def _faces(indices: np.ndarray, mode: int) -> np.ndarray:
    """(m, 3) faces of a list, strip or fan of vertices."""
    if mode == TRIANGLES:
        if len(indices) % 3:
            raise MeshFileError(f"found {len(indices)} indices in a list of triangles, expected a multiple of 3")
        return indices.reshape(-1, 3)
    if len(indices) < 3:
        return np.zeros((0, 3), np.int64)
    if mode == FAN:
        return np.stack([indices[1:-1], indices[2:], np.full(len(indices) - 2, indices[0])], axis=1)
    faces = np.stack([indices[:-2], indices[1:-1], indices[2:]], axis=1)
    faces[1::2] = faces[1::2][:, [0, 2, 1]]  # every other triangle of a strip is turned over
    return faces
