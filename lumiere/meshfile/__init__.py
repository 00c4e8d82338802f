"""Meshes from files, and the checks that meshes given in place share with them."""

from __future__ import annotations

from lumiere.meshfile.clean import clean, vertex_normals
from lumiere.meshfile.load import load_mesh
from lumiere.meshfile.part import FileMaterial, MeshPart

__all__ = ["FileMaterial", "MeshPart", "clean", "load_mesh", "vertex_normals"]
