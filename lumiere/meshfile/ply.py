"""PLY files (Turk 1994)."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from lumiere.meshfile.part import FileMaterial, MeshFileError, MeshPart
from lumiere.meshfile.trimesh_reader import as_utf8, read_with_trimesh


def read_ply(path: Path, materials: bool) -> list[MeshPart]:
    """The one mesh of a PLY file, with the texture that a comment ``TextureFile`` names."""
    data = path.read_bytes()
    header, body = _header(data)
    data = as_utf8(header) + data[len(header) :]
    _check_counts(header, body)
    # uvs at the corners of faces part the vertices, and trimesh then loses what else they carry.
    at_corners = re.search(rb"^property\s+list\s+\S+\s+\S+\s+texcoord\s*$", header, re.MULTILINE) is not None
    parts = []
    for part, mesh in read_with_trimesh(data, "ply", fix_texture=at_corners, skip_materials=True):
        _check_read(mesh.metadata["_ply_raw"])
        if at_corners:
            part.normals = part.colors = None
        part.material = _material(header, path.parent) if materials else None
        parts.append(part)
    return parts


def _header(data: bytes) -> tuple[bytes, bytes]:
    end = re.search(rb"^end_header[ \t]*\r?\n", data[: 1 << 20], re.MULTILINE)
    if not data.startswith(b"ply") or end is None:
        raise MeshFileError("found no PLY header, expected one from 'ply' to 'end_header'")
    return data[: end.start()], data[end.end() :]


def _check_counts(header: bytes, body: bytes) -> None:
    rows = [int(count) for count in re.findall(rb"^element\s+\S+\s+(-?\d+)\s*$", header, re.MULTILINE)]
    ascii_lines = len(body.splitlines()) if re.search(rb"^format\s+ascii\b", header, re.MULTILINE) else None
    most = len(body) if ascii_lines is None else ascii_lines
    if min(rows, default=0) < 0 or sum(rows) > most:
        raise MeshFileError(f"found {sum(rows)} rows of data promised by a file that holds at most {most}, expected all of them; it may be cut off")


def _check_read(elements: dict) -> None:
    """The lists of faces that trimesh took to be as long as the first are so."""
    data = elements.get("face", {}).get("data")
    if not isinstance(data, np.ndarray) or data.dtype.names is None:
        return
    for name in data.dtype.names:
        field = data[name]
        if field.dtype.names and np.any(field["f0"] != field["f1"].shape[1]):
            raise MeshFileError("found faces with different numbers of vertices in a binary file, expected all triangles or all quadrilaterals; "
                              "export it triangulated")


def _material(header: bytes, folder: Path) -> FileMaterial | None:
    named = re.search(rb"^comment\s+TextureFile\s+(.+?)\s*$", header, re.MULTILINE | re.IGNORECASE)
    if named is None:
        return None
    name = as_utf8(named.group(1)).decode("utf-8")
    if not (folder / name).is_file():
        raise MeshFileError(f"found no file {name!r}, which it names as its texture; put it beside")
    return FileMaterial(base_color_image=folder / name)
