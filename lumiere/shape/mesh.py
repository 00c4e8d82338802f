"""Meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from lumiere.errors import SceneError
from lumiere.meshfile.clean import wrong_index
from lumiere.scene.fields import array, boolean, file
from lumiere.shape import SHAPES, Primitives, Shape
from lumiere.shape.triangle import triangles


@SHAPES.register
@dataclass(kw_only=True)
class Mesh(Shape):
    """Triangles from a file (whatever trimesh loads) or given in place.

    Triangles with vertices that are not finite, with repeated indices or without an area are dropped, and counted in the record.
    """

    type: ClassVar[str] = "mesh"

    file: Any = file(None, nullable=True, doc="PLY, OBJ, STL, GLB/glTF, OFF, …; node transforms are kept")
    vertices: np.ndarray | None = array(size=3, doc="rows of x, y, z, metres")
    faces: np.ndarray | None = array(size=3, integers=True, doc="rows of three indices into vertices")
    normals: np.ndarray | None = array(size=3, doc="one a vertex")
    uvs: np.ndarray | None = array(size=2, doc="one a vertex")
    smooth: bool | None = boolean(None, nullable=True, doc="shade with interpolated vertex normals (default: where there are any)")
    use_file_materials: bool | None = boolean(None, nullable=True, doc="default: true where no material is given")

    def check(self) -> str | None:
        """What is wrong with the arrays, or None."""
        if (self.file is None) == (self.vertices is None):
            return "found both file and vertices, expected one of the two" if self.file else "found neither file nor vertices, expected one"
        if self.vertices is None:
            return None
        if self.faces is None:
            return "found vertices without faces, expected both"
        for name, values in (("normals", self.normals), ("uvs", self.uvs)):
            if values is not None and len(values) != len(self.vertices):
                return f"found {len(values)} {name} for {len(self.vertices)} vertices, expected one a vertex"
        return wrong_index(self.faces, len(self.vertices))

    def lower(self) -> list[Primitives]:
        from lumiere.compile.filematerial import material_of
        from lumiere.meshfile import MeshPart, clean, load_mesh, vertex_normals

        own_materials = self.material is None if self.use_file_materials is None else self.use_file_materials
        if self.file is not None:
            parts = load_mesh(self.file, materials=own_materials)
        else:
            parts = [MeshPart(vertices=self.vertices, faces=self.faces, normals=self.normals, uvs=self.uvs)]
        lowered = []
        for part in parts:
            faces, dropped = clean(part.vertices, part.faces)
            normals = part.normals if self.smooth is not False else None
            if self.smooth and normals is None:
                normals = vertex_normals(part.vertices, faces)
            primitives = triangles(np.nan_to_num(part.vertices, posinf=0.0, neginf=0.0), faces, self.matrix(), normals=normals,
                                   uvs=part.uvs, colors=part.colors)
            primitives.dropped = dropped
            if own_materials and part.material is not None:
                primitives.material = material_of(part.material)
            lowered.append(primitives)
        if not any(len(primitives.records) for primitives in lowered):
            raise SceneError("found no usable triangle, expected at least one", self)
        return lowered
