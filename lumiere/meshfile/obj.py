"""Wavefront OBJ files and their materials (MTL)."""

from __future__ import annotations

import math
import re
from pathlib import Path

from lumiere.meshfile.part import FileMaterial, MeshFileError, MeshPart
from lumiere.meshfile.trimesh_reader import as_utf8, read_with_trimesh

INDEX_ZERO = re.compile(rb"^f\b[^\n]*[ \t/]0+(?=[\s/]|$)", re.MULTILINE)
RELATIVE_INDEX = re.compile(rb"^f\b[^\n]*[ \t/]-\d", re.MULTILINE)
PICTURE_OPTION = re.compile(r"-(?:(?:o|s|t)(?:\s+[-+.\deE]+){1,3}|mm\s+\S+\s+\S+|[a-z]\w*\s+\S+)\s+")


def read_obj(path: Path, materials: bool) -> list[MeshPart]:
    """One part for each material of an OBJ file."""
    data = as_utf8(path.read_bytes())
    _check_indices(data)
    known = _library(data, path.parent) if materials else {}
    # trimesh only needs to know the names: it splits the mesh by them.
    names = "\n".join(f"newmtl {name}" for name in known).encode()
    parts = []
    for part, mesh in read_with_trimesh(data, "obj", names):
        part.material = known.get(getattr(getattr(mesh.visual, "material", None), "name", None))
        parts.append(part)
    return parts


def _check_indices(data: bytes) -> None:
    """What trimesh would read as another vertex."""
    if INDEX_ZERO.search(data):
        raise MeshFileError("found a face with the index 0, expected indices from 1")
    relative = RELATIVE_INDEX.search(data)
    if relative and data.rfind(b"\nv", relative.start()) >= 0:
        raise MeshFileError("found indices relative to vertices that are followed by more vertices; export it with indices from 1")


def _library(data: bytes, folder: Path) -> dict[str, FileMaterial]:
    """The materials of all files that ``mtllib`` lines name."""
    materials: dict[str, FileMaterial] = {}
    for line in re.findall(rb"^mtllib[ \t]+(.+?)\s*$", data, re.MULTILINE):
        named = line.decode("utf-8")
        for name in [named] if (folder / named).is_file() else named.split():
            materials |= _read_mtl(_beside(folder, name, "material library"))
    return materials


def _beside(folder: Path, name: str, what: str) -> Path:
    path = next((p for p in (folder / name, folder / name.replace("\\", "/")) if p.is_file()), None)
    if path is None:
        raise MeshFileError(f"found no file {name!r}, which it names as its {what}; put it where it belongs")
    return path


def _read_mtl(path: Path) -> dict[str, FileMaterial]:
    """Materials by name (Wavefront, "MTL material format", 1995; Pr, Pm and norm: its extension for physically based rendering)."""
    materials: dict[str, FileMaterial] = {}
    material = FileMaterial()
    shininess, shiny = 0.0, False
    for line in as_utf8(path.read_bytes()).decode("utf-8").splitlines():
        key, _, rest = line.strip().replace("\t", " ").partition(" ")
        key, rest = key.lower(), rest.strip()
        try:
            if key == "newmtl":
                material, shininess, shiny = FileMaterial(name=rest), 0.0, False
                materials[rest] = material
            elif key == "kd":
                material.base_color = _color(rest)
            elif key == "ke":
                material.emission = _color(rest)
            elif key == "ks":
                shiny = max(_color(rest)) > 0.0
            elif key == "ns":
                shininess = max(0.0, _number(rest))
            elif key == "pr":
                material.roughness = _number(rest)
            elif key == "pm":
                material.metallic = _number(rest)
            elif key == "d":  # and not Tr, of which some programs write the complement
                material.opacity = _number(rest.replace("-halo", ""))
                material.alpha_mode = "blend" if material.opacity < 1.0 else "opaque"
            elif key in ("map_kd", "map_ke", "norm"):
                picture = _beside(path.parent, PICTURE_OPTION.sub("", f"{rest} ").strip(), f"picture {key} of material {material.name!r}")
                setattr(material, {"map_kd": "base_color_image", "map_ke": "emission_image", "norm": "normal_image"}[key], picture)
        except (ValueError, IndexError):
            raise MeshFileError(f"found {line.strip()!r} in {path.name}, expected numbers after {key}") from None
        if key in ("ks", "ns") and shiny:
            # The Blinn–Phong lobe of exponent n is about as wide as GGX of α² = 2 / (n + 2) (Walter et al. 2007); roughness² = α.
            material.roughness = math.sqrt(math.sqrt(2.0 / (shininess + 2.0)))
    return materials


def _number(text: str) -> float:
    value = float(text.split()[0])
    if not math.isfinite(value):
        raise ValueError(text)
    return value


def _color(text: str) -> tuple[float, float, float]:
    values = [_number(word) for word in text.split()[:3]]
    return (values[0], values[0], values[0]) if len(values) < 3 else (values[0], values[1], values[2])
