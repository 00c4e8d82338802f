"""Shading normals: mirrored light leaves the surface, and triangles that stand for something smooth cast no shadow on it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl
import pytest

import lumiere
from lumiere.texture.image import ImageTexture


def tilted(degrees: float) -> ImageTexture:
    """A normal map that tilts everything along u."""
    angle = np.radians(degrees)
    return ImageTexture(pixels=np.float32([[[0.5 + 0.5 * np.sin(angle), 0.5, 0.5 + 0.5 * np.cos(angle)]]]), encoding="linear")


@pytest.mark.parametrize("tilt", [-85.0, -40.0, 40.0, 85.0])
@pytest.mark.parametrize("height", [0.15, 2.0])
def test_a_tilted_mirror_still_mirrors_the_sky(device: cl.Device, tilt: float, height: float) -> None:
    """In a sky of radiance 1 a perfect mirror shows 1 whatever its normals, so long as mirrored light leaves the surface."""
    scene = lumiere.load({"scene": {
        "film": {"width": 16, "height": 16}, "camera": {"position": [0, height, 2], "look_at": [0, 0, 0], "fov": 20},
        "materials": {"mirror": {"type": "mirror", "normal_map": {"type": "constant"}}},
        "geometry": [{"type": "rectangle", "transform": [{"rotate": {"axis": [1, 0, 0], "angle": -90}}], "material": "mirror"}],
        "lights": [{"type": "environment", "radiance": 1}]}})
    scene.materials["mirror"].normal_map = tilted(tilt)
    image = lumiere.render(scene, spp=4, device=device.name)
    np.testing.assert_allclose(image.pixels, 1.0, rtol=1e-5)


def octahedron() -> dict[str, Any]:
    vertices = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    return {"type": "mesh", "vertices": vertices, "faces": faces, "normals": vertices, "smooth": True}


def test_coarse_smooth_meshes_shade_as_their_normals_say(device: cl.Device) -> None:
    """Under one distant light an octahedron with a sphere's normals is lit by their cosine alone: albedo E cosθ / π."""
    direction = np.array([-1.0, -0.3, -0.4])
    image = lumiere.render({"scene": {
        "film": {"width": 48, "height": 48, "aovs": ["normal"]}, "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "fov": 26},
        "geometry": [octahedron()], "lights": [{"type": "directional", "direction": list(direction), "irradiance": np.pi}]}},
        spp=4, max_depth=1, device=device.name)
    normal = image.aovs["normal"]
    inside = np.abs(np.linalg.norm(normal, axis=-1) - 1.0) < 0.01
    cosine = normal @ (-direction / np.linalg.norm(direction))
    assert np.count_nonzero(inside & (cosine > 0.05)) > 300
    lit = inside & (np.abs(cosine) > 0.05)  # of pixels on the terminator, only some samples are lit
    np.testing.assert_allclose(image.pixels[lit][:, 0], 0.8 * np.maximum(cosine[lit], 0.0), atol=0.01)
