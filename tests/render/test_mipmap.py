"""Pictures filtered over what a ray's cone covers: the pyramid, the level, and the cone's way through the scene, against closed forms."""

from __future__ import annotations

import itertools

import numpy as np
import pyopencl as cl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lumiere
from lumiere.compile.scene import compile_scene
from lumiere.film.image import Image
from lumiere.scene.load import load
from lumiere.texture.image import ImageTexture
from lumiere.texture.pyramid import pyramid
from lumiere.wavefront.state import path_fields
from tests.render.scenes import POINT_FILTER, Json, from_above, index_of

Array = np.ndarray

TEXELS = np.random.default_rng(3).random((64, 64, 3), dtype=np.float32)
UP, DOWN = ([{"rotate": {"axis": [1, 0, 0], "angle": angle}}] for angle in (-90, 90))


def luminous(filter: str, pixels: Array = TEXELS, *transform: Json, scale: float = 1.0) -> Json:
    """A square of 2 m that emits what the picture shows."""
    return {"type": "rectangle", "transform": [*(transform or UP)], "material": {"type": "lambert", "albedo": 0.0, "emission": [1, 1, 1]},
            "picture": ImageTexture(pixels=pixels, encoding="linear", filter=filter, scale=(scale, scale))}


def shown(device: cl.Device, camera: Json, *geometry: Json, width: int = 16, spp: int = 1, filter: Json = POINT_FILTER, **options: object) -> Image:
    """What ``camera`` sees of things that emit their ``picture``, if they have one."""
    pictures = [shape.pop("picture", None) for shape in geometry]
    scene = lumiere.load({"scene": {"camera": camera, "film": {"width": width, "height": width, "filter": filter}, "geometry": list(geometry)}})
    for shape, picture in zip(scene.geometry, pictures, strict=True):
        if picture is not None:
            shape.material.emission = picture
    return lumiere.render(scene, spp=spp, device=index_of(device), **options)


def bilinear(texels: Array, at: Array) -> Array:
    """``texels`` (h, w, 3), row 0 at the top, repeated, at uv ``at`` (n, 2)."""
    rows = texels[::-1]
    height, width = rows.shape[:2]
    x, y = at[:, 0] * width - 0.5, at[:, 1] * height - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    f, g = (x - i)[:, None], (y - j)[:, None]

    def texel(dx: int, dy: int) -> Array:
        return rows[(j + dy) % height, (i + dx) % width]

    return (1 - g) * ((1 - f) * texel(0, 0) + f * texel(1, 0)) + g * ((1 - f) * texel(0, 1) + f * texel(1, 1))


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 70), st.integers(1, 70))
def test_every_level_has_the_pictures_mean(height: int, width: int) -> None:
    values = np.random.default_rng(height * 71 + width).random((height, width, 4))
    levels = pyramid(values)
    assert levels[0] is values and levels[-1].shape == (1, 1, 4) and len(levels) == 1 + int(np.log2(max(height, width)))
    for finer, level in itertools.pairwise(levels):
        assert level.shape[:2] == (max(1, finer.shape[0] // 2), max(1, finer.shape[1] // 2))
        np.testing.assert_allclose(level.mean(axis=(0, 1)), values.mean(axis=(0, 1)), rtol=1e-12)


def test_the_size_of_odd_pictures_is_shared_out_evenly() -> None:
    """Three texels make one, five make two of 2½ each."""
    np.testing.assert_allclose(pyramid(np.array([[[3.0]], [[6.0]], [[0.0]]]))[1].ravel(), [3.0])
    np.testing.assert_allclose(pyramid(np.array([5.0, 0.0, 10.0, 0.0, 0.0]).reshape(1, 5, 1))[1].ravel(), [(5 + 0 + 5) / 2.5, 5 / 2.5])


@pytest.mark.parametrize(("width", "scale"), [(8, 1.0), (16, 4.0), (12, 2.5), (12, 9.0)])
def test_the_level_has_texels_as_wide_as_the_cone(device: cl.Device, width: int, scale: float) -> None:
    """A cone is a quarter of a pixel wide: at 64 · scale texels across the picture it takes what lies between the levels around log₂ of its texels."""
    image = shown(device, from_above(3.0, 2.0), luminous("mipmap", scale=scale), width=width)
    level = np.log2(0.25 * 64 * scale / width)
    at = (np.arange(width) + 0.5) / width
    u, v = np.meshgrid(at, 1.0 - at)
    places = np.stack([u.ravel(), v.ravel()], axis=1) * scale
    levels = pyramid(TEXELS.astype(np.float64))
    low, part = int(level), level - int(level)
    expected = (1 - part) * bilinear(levels[low], places) + part * bilinear(levels[low + 1], places)
    np.testing.assert_allclose(image.pixels.reshape(-1, 3), expected, atol=1e-3)


def test_cones_narrower_than_a_texel_change_nothing(device: cl.Device) -> None:
    filtered, plain = (shown(device, from_above(3.0, 2.0), luminous(name), width=32).pixels for name in ("mipmap", "bilinear"))
    assert np.array_equal(filtered, plain)


def test_distance_counts_along_the_whole_way(device: cl.Device) -> None:
    """A picture in a flat mirror is filtered as the same picture as far away as the path is long."""
    def looks_down(height: float) -> Json:
        return {"position": [0, height, 0], "look_at": [0, height - 1, 0], "up": [0, 0, -1], "fov": 30}

    larger = {"scale": 2}
    seen = shown(device, looks_down(3.0), luminous("mipmap", TEXELS, larger, *UP, scale=4.0))
    mirror = {"type": "rectangle", "transform": [larger, *UP], "material": {"type": "mirror"}}
    mirrored = shown(device, looks_down(1.0), mirror, luminous("mipmap", TEXELS[::-1], larger, *DOWN, {"translate": [0, 2, 0]}, scale=4.0))
    np.testing.assert_allclose(mirrored.pixels, seen.pixels, atol=1e-3)
    assert np.abs(seen.pixels - shown(device, looks_down(3.0), luminous("bilinear", TEXELS, larger, *UP, scale=4.0)).pixels).max() > 0.1


def test_slanted_views_cover_more(device: cl.Device) -> None:
    """Seen along the ground, one sample of a checkered picture is nearly its mean, and not black or white."""
    checkered = (np.indices((2, 2)).sum(axis=0) % 2)[..., None].repeat(3, axis=2).astype(np.float32)
    camera = {"position": [0, 1, 0], "look_at": [0, 0, -10], "fov": 10}
    far = {"scale": 100}
    plain, filtered = (shown(device, camera, luminous(f, checkered, far, *UP, scale=4000.0)).pixels for f in ("bilinear", "mipmap"))
    assert plain.std() > 0.1
    assert filtered.std() < 0.02 and abs(filtered.mean() - 0.5) < 0.01


def test_light_from_a_filtered_picture_is_not_lost(device: cl.Device) -> None:
    """Cones that diffuse reflection has widened see a bright picture's mean: the floor is as bright as below the picture as it is."""
    floor = {"type": "rectangle", "transform": [{"scale": 0.2}, *UP], "material": {"type": "lambert", "albedo": 0.8}}
    means, variances = [], []
    for name in ("bilinear", "mipmap"):
        above = luminous(name, TEXELS**4, *DOWN, {"translate": [0, 1, 0]})
        image = shown(device, from_above(0.5, 0.3), floor, above, spp=256, filter={"type": "box", "radius": 0.5}, max_depth=1)
        means.append(image.pixels.mean(axis=(0, 1)))
        variances.append(image.variance.mean(axis=(0, 1)) / (16 * 16))
    deviation = np.abs(means[0] - means[1]) / np.sqrt(variances[0] + variances[1])
    assert np.all(deviation < 4.0) and np.all(means[0] > 0.05)


def test_only_filtered_pictures_make_paths_carry_cones() -> None:
    def fields(filter: str) -> set[str]:
        picture = luminous(filter)
        texture = picture.pop("picture")
        scene = load({"scene": {"geometry": [picture]}})
        scene.geometry[0].material.emission = texture
        return {field.name for field in path_fields(compile_scene(scene).features)}

    assert fields("mipmap") - fields("bilinear") == {"cone_width", "cone_spread"}
