"""STL and OFF, and whatever else trimesh knows."""

from __future__ import annotations

import re
import struct
from pathlib import Path

from lumiere.meshfile.part import MeshFileError, MeshPart
from lumiere.meshfile.trimesh_reader import as_utf8, known_suffixes, read_with_trimesh
from lumiere.registry import nearest

MAX_UNPACKED = 1 << 32
"""Bytes that a file which is an archive may unpack to."""


def read_stl(path: Path, materials: bool) -> list[MeshPart]:
    """A binary STL file's triangles, or an ASCII one's solids. It has no materials."""
    data = path.read_bytes()
    if len(data) >= 84 and len(data) != 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        lines = data.rstrip().splitlines()
        if b"facet" not in data:
            promised = struct.unpack_from("<I", data, 80)[0]
            raise MeshFileError(f"found {len(data)} bytes and {promised} triangles promised, which take {84 + 50 * promised}; it may be cut off")
        if not lines[-1].strip().lower().startswith(b"endsolid"):
            raise MeshFileError("found an ASCII file that does not end with 'endsolid', expected a whole one; it may be cut off")
        data = as_utf8(data)
    return [part for part, _ in read_with_trimesh(data, "stl")]


def read_other(path: Path, materials: bool) -> list[MeshPart]:
    """The meshes of a file of any other format, without materials."""
    suffix = path.suffix.lower().lstrip(".")
    known = sorted(known_suffixes())
    if suffix not in known:
        close = nearest(suffix, known)
        hint = f"; did you mean {close}?" if close else ""
        raise MeshFileError(f"found a file of type {suffix!r}, expected one of {', '.join(known)}{hint}")
    _check_archive(path)
    data = path.read_bytes()
    if suffix == "off":
        data = as_utf8(data)
        _check_off(data)
    return [part for part, _ in read_with_trimesh(data, suffix)]


def _check_archive(path: Path) -> None:
    import zipfile

    if zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as archive:
            unpacked = sum(entry.file_size for entry in archive.infolist())
        if unpacked > MAX_UNPACKED:
            raise MeshFileError(f"found an archive that unpacks to {unpacked} bytes, expected at most {MAX_UNPACKED}")


def _check_off(data: bytes) -> None:
    """The rows that an OFF file promises are there; trimesh does with fewer."""
    text = re.sub(rb"#[^\n]*", b"", data).partition(b"OFF")[2]
    rows = [row.split() for row in text.splitlines() if row.strip()]
    try:
        vertices, faces = int(rows[0][0]), int(rows[0][1])
        whole = len(rows) > vertices + faces and all(len(row) > int(row[0]) >= 3 for row in rows[1 + vertices : 1 + vertices + faces])
    except (IndexError, ValueError):
        raise MeshFileError("found no counts of vertices and faces, expected an OFF file") from None
    if not whole:
        raise MeshFileError(f"found fewer whole rows than the {vertices} vertices and {faces} faces promised; it may be cut off")
