"""What a mesh file holds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

Picture = Path | np.ndarray
"""A picture's file, or the picture where it is inside the mesh file: (h, w, c) uint8 or float32, row 0 at the top."""


class MeshFileError(Exception):
    """What a mesh file does wrong, as the rest of a line that begins with the file's name."""


@dataclass
class FileMaterial:
    """A material as files describe it, in the terms of glTF's metallic-roughness model. Factors multiply what the pictures say.

    ``base_color`` and ``emission`` are linear Rec. 709; the pictures of both are encoded as sRGB. ``metallic_roughness_image`` is linear and
    holds roughness in green, metallic in blue. ``normal_image`` is in tangent space and linear. ``opacity`` is multiplied by the alpha of
    ``base_color_image``, and counts only where ``alpha_mode`` is ``blend`` (as it is) or ``mask`` (1 from ``alpha_cutoff`` up, else 0), not
    where it is ``opaque``.

    What follows ``double_sided`` is what glTF's extensions add. Of their pictures, linear but for the two colours', ``clearcoat_image`` and
    ``transmission_image`` count by red, ``clearcoat_roughness_image`` by green, ``sheen_roughness_image`` and ``specular_image`` by alpha.
    ``thin`` says that what transmits is a film without volume; ``unlit`` that the base colour is what is seen, whatever the light.
    """

    name: str = ""
    base_color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    base_color_image: Picture | None = None
    metallic: float = 0.0
    roughness: float = 1.0
    metallic_roughness_image: Picture | None = None
    normal_image: Picture | None = None
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    emission_image: Picture | None = None
    opacity: float = 1.0
    alpha_mode: str = "opaque"
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    normal_scale: float = 1.0
    ior: float = 1.5
    specular: float = 1.0
    specular_image: Picture | None = None
    specular_color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    specular_color_image: Picture | None = None
    clearcoat: float = 0.0
    clearcoat_image: Picture | None = None
    clearcoat_roughness: float = 0.0
    clearcoat_roughness_image: Picture | None = None
    sheen_color: tuple[float, float, float] = (0.0, 0.0, 0.0)
    sheen_color_image: Picture | None = None
    sheen_roughness: float = 0.0
    sheen_roughness_image: Picture | None = None
    transmission: float = 0.0
    transmission_image: Picture | None = None
    thin: bool = True
    anisotropy: float = 0.0
    unlit: bool = False


@dataclass
class MeshPart:
    """Triangles that share a material, in the file's world space.

    ``vertices`` (n, 3) float64; ``faces`` (m, 3) int; ``normals`` (n, 3) float64, ``uvs`` (n, 2) float64 with (0, 0) at the picture's bottom
    left, and ``colors`` (n, 3) float64 linear Rec. 709 where the file has them.
    """

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None
    colors: np.ndarray | None = None
    material: FileMaterial | None = None


def place(part: MeshPart, matrix: np.ndarray) -> MeshPart:
    """``part`` transformed by a (4, 4) matrix. A mirroring one turns the faces over, so that their front stays in front."""
    if np.array_equal(matrix, np.eye(4)):
        return part
    linear = matrix[:3, :3]
    determinant = np.linalg.det(linear)
    normals = part.normals
    if normals is not None and determinant != 0.0:
        normals = normals @ np.linalg.inv(linear)  # the inverse transpose, from the right
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = normals / np.where(lengths > 0.0, lengths, 1.0)
    return MeshPart(part.vertices @ linear.T + matrix[:3, 3], part.faces[:, ::-1] if determinant < 0.0 else part.faces, normals,
                    part.uvs, part.colors, part.material)
