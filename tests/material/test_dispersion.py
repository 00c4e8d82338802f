"""Dispersion: where each channel goes through a prism, and that glass without it is as it was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PIL.Image
import pyopencl as cl
import pytest

import lumiere
from lumiere.compile.scene import compile_scene
from lumiere.errors import SceneError
from tests.bsdf.dispersion import TENTS, cauchy, wavelength
from tests.render.scenes import Json, assert_mean, render

APEX = np.radians(25.0)
WALL = 4.0
"""Metres from the middle of the prism's leaning side to a wall whose radiance runs from 0 at a height of −2 m to 1 at 2 m."""
THROUGH = {"max_depth": 2, "russian_roulette_depth": None}


@pytest.fixture(scope="module")
def ramp(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two texels between which a texture is linear."""
    path = tmp_path_factory.mktemp("ramp") / "ramp.png"
    PIL.Image.fromarray(np.array([[255], [0]], np.uint8)).save(path)
    return path


def prism(ramp: Path, glass: Json, **keys: object) -> Json:
    """Seen from +Z, square on: a wedge of glass, its apex below, before the wall."""
    low, high = -np.tan(APEX), np.tan(APEX)  # z of the leaning side at y = 1 and y = -1, which passes through the origin
    vertices = [[x, y, 1.0] for x, y in ((-9, -1), (9, -1), (9, 1), (-9, 1))]
    vertices += [[x, y, low if y > 0 else high] for x, y in ((-9, -1), (9, -1), (9, 1), (-9, 1))]
    faces = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6], [0, 4, 5], [0, 5, 1], [3, 2, 6], [3, 6, 7], [0, 3, 7], [0, 7, 4], [1, 5, 6], [1, 6, 2]]
    emission = {"type": "image", "file": str(ramp), "encoding": "linear", "wrap": "clamp"}
    wall = {"type": "rectangle", "transform": [{"scale": [4, 4, 1]}, {"translate": [0, 0, -WALL]}],
            "material": {"type": "lambert", "albedo": 0, "emission": emission}}
    return {"camera": {"type": "orthographic", "position": [0, 0, 9], "look_at": [0, 0, 0], "height": 1e-4}, "film": {"width": 16, "height": 16},
            "sampler": {"type": "independent", "spp": 512}, "integrator": THROUGH,
            "geometry": [{"type": "mesh", "vertices": vertices, "faces": faces, "material": {"type": "dielectric", **glass}}, wall], **keys}


def expected(ior: float, abbe_number: float) -> np.ndarray:
    """(3,) radiance seen through the prism: Snell's law and Fresnel's equations at the leaning side, over each channel's wavelengths."""
    u = (np.arange(2000) + 0.5) / 2000
    radiance = []
    for tent in TENTS:
        n = cauchy(ior, abbe_number, wavelength(u, tent))
        out = np.arcsin(n * np.sin(APEX))
        height = WALL * np.tan(out - APEX)  # bent towards the thick side, which is up for an apex below
        s = (n * np.cos(APEX) - np.cos(out)) / (n * np.cos(APEX) + np.cos(out))
        p = (np.cos(APEX) - n * np.cos(out)) / (np.cos(APEX) + n * np.cos(out))
        passes = (1.0 - ((n - 1.0) / (n + 1.0)) ** 2) * (1.0 - 0.5 * (s**2 + p**2))
        radiance.append(np.mean(passes * np.clip(0.5 + height / 4.0, 0.0, 1.0)))
    return np.array(radiance)


@pytest.mark.parametrize(("ior", "abbe_number"), [(1.5, 60.0), (1.7, 8.0)])
def test_a_prism_bends_each_channel_by_snells_law(device: cl.Device, ramp: Path, ior: float, abbe_number: float) -> None:
    glass = {"ior": ior, "abbe_number": abbe_number}
    assert np.ptp(expected(ior, abbe_number)) > 0.002  # and so blue and red are told apart
    assert_mean(render(device, prism(ramp, glass)), expected(ior, abbe_number))


def test_what_carries_one_channel_draws_none(device: cl.Device, ramp: Path) -> None:
    """Seen through a red filter the prism loses no sample to green and blue: the noise is that of reflection and of the wavelengths alone."""
    plain = prism(ramp, {"ior": 1.5, "abbe_number": 60.0}, integrator=THROUGH | {"max_depth": 3})
    red_filter = {"type": "rectangle", "transform": [{"scale": 5}, {"translate": [0, 0, 3]}],
                  "material": {"type": "thin_dielectric", "ior": 1, "transmittance": [1, 0, 0]}}
    red, full = render(device, plain | {"geometry": [*plain["geometry"], red_filter]}), render(device, plain)
    assert red.pixels[..., 1:].max() == 0.0
    np.testing.assert_allclose(red.pixels[..., 0].mean(), expected(1.5, 60.0)[0], rtol=0.01)
    assert full.variance[..., 0].mean() > 5.0 * red.variance[..., 0].mean()


@pytest.mark.parametrize("roughness", [0.0, 0.4])
def test_an_endless_abbe_number_is_plain_glass(device: cl.Device, ramp: Path, roughness: float) -> None:
    """The same mean as of glass without; where it is smooth, channels that no angle tells apart are still drawn one at a time."""
    plain = render(device, prism(ramp, {"ior": 1.6, "roughness": roughness}))
    endless = render(device, prism(ramp, {"ior": 1.6, "roughness": roughness, "abbe_number": 1e30}))
    difference = endless.pixels.astype(np.float64) - plain.pixels
    z = difference.mean(axis=(0, 1)) / np.sqrt((endless.variance + plain.variance).mean(axis=(0, 1)) / 256 + 1e-14)
    assert np.all(np.abs(z) < 4.5), z


@pytest.mark.parametrize("roughness", [0.0, 0.3])
def test_white_furnace(device: cl.Device, roughness: float) -> None:
    """A ball of flint glass under a white sky is invisible."""
    ball = {"type": "sphere", "radius": 0.4, "material": {"type": "dielectric", "ior": 1.7, "abbe_number": 10.0, "roughness": roughness}}
    image = render(device, {"camera": {"type": "orthographic", "position": [0, 0, 9], "look_at": [0, 0, 0], "height": 1},
                            "film": {"width": 16, "height": 16}, "sampler": {"spp": 256}, "integrator": {"max_depth": 200, "russian_roulette_depth": None},
                            "geometry": [ball], "lights": [{"type": "environment", "radiance": 1}]})
    mean, error = image.pixels.mean(axis=(0, 1)), np.sqrt(image.variance.mean(axis=(0, 1)) / 256)
    assert np.all(np.abs(mean - 1.0) < 4.5 * error + (0.01 if roughness else 1e-4)), f"found {mean} ± {error}"


def test_only_glass_that_disperses_computes_it() -> None:
    def features(**glass: object) -> tuple[str, ...]:
        return compile_scene(lumiere.load({"scene": {"geometry": [{"type": "sphere", "material": {"type": "dielectric", **glass}}]}})).features.bsdf_features[
            "dielectric"]

    assert features() == () and features(abbe_number=30.0) == ("DISPERSION",)
    assert features(abbe_number=30.0, transmittance_distance=1.0) == ("ABSORPTION", "DISPERSION")


@pytest.mark.parametrize(("glass", "complaint"), [({"abbe_number": 0.5}, "found 0.5"), ({"abbe_number": 30, "priority": 1}, "not supported yet")])
def test_complaints(glass: Json, complaint: str) -> None:
    with pytest.raises(SceneError, match=complaint):
        lumiere.load({"scene": {"geometry": [{"type": "sphere", "material": {"type": "dielectric", **glass}}]}})
