"""Files read through trimesh, without its noise and without believing what it passes over in silence."""

from __future__ import annotations

import io
import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from lumiere.meshfile.part import MeshFileError, MeshPart, place

SILENT_LOSSES = ("index failed on UV", "failed to load vertex", "face lines are weird", "face needs more values", "no vertices found")
"""Beginnings of trimesh's debug messages that mean that something in the file was left out."""


def known_suffixes() -> set[str]:
    """What trimesh reads here; some formats need packages that may be missing. Archives are not among them."""
    import trimesh

    return set(trimesh.exchange.load.mesh_formats()) - {"stl_ascii", "xyz"}


def read_with_trimesh(data: bytes, suffix: str, beside: bytes | None = None, **options: Any) -> list[tuple[MeshPart, Any]]:
    """The parts of a file's bytes, each with trimesh's own mesh, without materials. Whatever file it names is said to hold the bytes ``beside``,
    or not to be there; ``options`` go to trimesh's loader. Raises MeshFileError.
    """
    import trimesh

    losses: list[str] = []
    try:
        with _watch(losses):
            scene = trimesh.load_scene(io.BytesIO(data), file_type=suffix, resolver=_Beside(beside), process=False, **options)
            parts = list(_parts(scene, trimesh.Trimesh))
    except (MeshFileError, MemoryError):
        raise
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        raise MeshFileError(f"found a broken {suffix.upper()} file ({reason}), expected a whole one; export it again") from None
    if losses:
        raise MeshFileError(f"found a broken {suffix.upper()} file ({losses[0]}), expected a whole one; export it again")
    return parts


def as_utf8(text: bytes) -> bytes:
    """A text that is not UTF-8 is taken as Latin-1, in which every byte is a letter: names and comments only."""
    try:
        text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1").encode("utf-8")
    return text


class _Beside:
    """Stands for the files in the same folder."""

    def __init__(self, data: bytes | None) -> None:
        self._data = data

    def get(self, name: str) -> bytes:
        return self[name]

    def __getitem__(self, name: str) -> bytes:
        if self._data is None:
            raise FileNotFoundError(name)
        return self._data


@contextmanager
def _watch(losses: list[str]) -> Iterator[None]:
    """Keeps trimesh and numpy from writing to stderr; gathers what tells of losses."""
    log = logging.getLogger("trimesh")

    class Watch(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            message = " ".join(record.getMessage().split())
            if record.levelno >= logging.WARNING or message.startswith(SILENT_LOSSES):
                losses.append(message)

    before = log.handlers, log.propagate, log.level
    log.handlers, log.propagate = [Watch()], False
    log.setLevel(logging.DEBUG)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # numpy's word for a text that stopped being numbers.
            warnings.filterwarnings("error", message="string or file could not be read to its end")
            yield
    finally:
        log.handlers, log.propagate, level = before
        log.setLevel(level)


def _parts(scene: Any, mesh_class: type) -> Iterator[tuple[MeshPart, Any]]:
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        mesh = scene.geometry[name]
        if isinstance(mesh, mesh_class) and len(mesh.faces):
            yield place(_part(mesh), np.asarray(matrix, np.float64)), mesh


def _part(mesh: Any) -> MeshPart:
    vertices = np.array(mesh.vertices, np.float64)
    # trimesh makes normals up where the file has none; those that it read lie in its cache from the start.
    normals = np.array(mesh.vertex_normals, np.float64) if "vertex_normals" in mesh._cache else None
    uvs = colors = None
    if mesh.visual.kind == "texture" and mesh.visual.uv is not None:
        uvs = np.array(mesh.visual.uv, np.float64)
        colors = mesh.vertex_attributes.get("color")
    elif mesh.visual.kind == "vertex":
        colors = mesh.visual.vertex_colors
    return MeshPart(vertices, np.array(mesh.faces, np.int64), normals, uvs, None if colors is None else _linear(np.asarray(colors)[:, :3]))


def _linear(colors: np.ndarray) -> np.ndarray:
    """Colours from a file: bytes are sRGB, floats are linear."""
    from lumiere.compile.textures import srgb_decode

    return srgb_decode(colors / 255.0) if colors.dtype == np.uint8 else colors.astype(np.float64)
