"""Any mesh file → its parts."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from lumiere.errors import SceneError
from lumiere.meshfile.clean import wrong_index
from lumiere.meshfile.part import MeshFileError, MeshPart


def load_mesh(path: str | Path, materials: bool = True) -> list[MeshPart]:
    """The parts of a mesh file, one for each place where the file puts a geometry of one material.

    glTF and GLB are read here: their uv sets, packed numbers and pictures do not survive trimesh. All else that trimesh knows is read
    through it. Without ``materials``, neither they nor the files that they name are read. Raises SceneError where the file cannot be read, is
    not what it says it is, names vertices or files that are not there, or holds no triangle.
    """
    about, path = path, Path(path)
    try:
        with np.errstate(all="ignore"):  # NaN and infinities may be in the file; `clean` finds them
            parts = _reader(path)(path, materials)
        for part in parts:
            _check(part)
        if not any(len(part.faces) for part in parts):
            raise MeshFileError("found no triangle, expected at least one")
    except MeshFileError as problem:
        raise SceneError(f"{path}: {problem}", about) from None
    except OSError as error:
        raise SceneError(f"{path}: found that it cannot be read ({error.strerror or error}), expected a mesh file", about) from None
    except MemoryError:
        raise SceneError(f"{path}: found a mesh that does not fit into memory, expected a smaller one", about) from None
    return parts


def _reader(path: Path) -> Callable[[Path, bool], list[MeshPart]]:
    suffix = path.suffix.lower()
    if suffix in (".gltf", ".glb"):
        from lumiere.meshfile.gltf import read_gltf as reader
    elif suffix == ".obj":
        from lumiere.meshfile.obj import read_obj as reader
    elif suffix == ".ply":
        from lumiere.meshfile.ply import read_ply as reader
    elif suffix == ".stl":
        from lumiere.meshfile.other import read_stl as reader
    else:
        from lumiere.meshfile.other import read_other as reader
    return reader


def _check(part: MeshPart) -> None:
    faces, count = part.faces, len(part.vertices)
    for name, array, shape in (("vertices", part.vertices, (count, 3)), ("faces", faces, (len(faces), 3)), ("normals", part.normals, (count, 3)),
                               ("uvs", part.uvs, (count, 2)), ("colours", part.colors, (count, 3))):
        if array is not None and array.shape != shape:
            raise MeshFileError(f"found {name} of shape {array.shape}, expected {shape}")
    complaint = wrong_index(faces, count)
    if complaint is not None:
        raise MeshFileError(complaint)
