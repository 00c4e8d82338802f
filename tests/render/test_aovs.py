"""The film's further layers, against what the scene is made of."""

from __future__ import annotations

from functools import cache

import numpy as np
import pyopencl as cl

from lumiere.film.image import Image
from tests.render.scenes import POINT_FILTER, Json, assert_exact, render

Array = np.ndarray

WIDTH, HEIGHT, FOV = 32, 24, 60.0
EYE, TARGET = np.array([0.5, 2.0, 5.0]), np.array([0.0, 0.6, 0.0])
SPHERE, RADIUS = np.array([-1.2, 0.8, 0.0]), 0.8
AOVS = ["albedo", "normal", "depth", "position", "uv", "material_id", "object_id", "sample_count", "variance", "direct", "indirect", "emission"]
FLOOR, BALL, WALL, LAMP, NOTHING = 0, 1, 2, 3, -1


def scene(**film: object) -> Json:
    """A floor, a ball, a wall and a lamp."""
    wall = [{"translate": [1.6, 1.01, -1.0]}]
    return {
        "camera": {"position": list(EYE), "look_at": list(TARGET), "fov": FOV},
        "film": {"width": WIDTH, "height": HEIGHT, "aovs": AOVS} | film, "sampler": {"type": "independent", "spp": 16},
        "materials": {"grey": {"type": "lambert", "albedo": 0.5}, "red": {"type": "lambert", "albedo": [0.8, 0.2, 0.1]},
                      "checked": {"type": "lambert", "albedo": {"type": "checker", "a": 0.7, "b": 0.3, "scale": 4}}},
        "geometry": [{"type": "plane", "material": "grey"}, {"type": "sphere", "position": list(SPHERE), "radius": RADIUS, "material": "red"},
                     {"type": "rectangle", "transform": wall, "material": "checked"},
                     {"type": "disk", "position": [0.2, 2.2, -0.5], "normal": [0, 0, 1], "radius": 0.5, "material": "grey", "emission": [5, 4, 3]}]}


@cache
def picture(device: cl.Device) -> Image:
    """Every sample at its pixel's centre."""
    return render(device, scene(filter=POINT_FILTER))


def rays() -> Array:
    """(HEIGHT, WIDTH, 3) unit directions through the pixels' centres."""
    forward = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    half = np.tan(np.radians(FOV) / 2.0)
    x = (2.0 * (np.arange(WIDTH) + 0.5) / WIDTH - 1.0) * half * WIDTH / HEIGHT
    y = (1.0 - 2.0 * (np.arange(HEIGHT) + 0.5) / HEIGHT) * half
    d = forward + x[None, :, None] * right + y[:, None, None] * np.cross(right, forward)
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


def first_hits() -> tuple[Array, Array]:
    """Distance and object that each ray meets first: 0 and NOTHING where that is the sky."""
    d = rays()
    with np.errstate(divide="ignore", invalid="ignore"):
        floor = np.where(d[..., 1] < 0.0, -EYE[1] / d[..., 1], np.inf)
        b = d @ (SPHERE - EYE)
        discriminant = b * b - (np.sum((SPHERE - EYE) ** 2) - RADIUS**2)
        ball = np.where(discriminant > 0.0, b - np.sqrt(np.maximum(discriminant, 0.0)), np.inf)
        wall = (-1.0 - EYE[2]) / d[..., 2]
        at = EYE + wall[..., None] * d - (1.6, 1.01, -1.0)
        wall = np.where((np.abs(at[..., 0]) < 1.0) & (np.abs(at[..., 1]) < 1.0), wall, np.inf)
        lamp = (-0.5 - EYE[2]) / d[..., 2]
        at = EYE + lamp[..., None] * d - (0.2, 2.2, -0.5)
        lamp = np.where(np.hypot(at[..., 0], at[..., 1]) < 0.5, lamp, np.inf)
    distances = np.stack([floor, ball, wall, lamp])
    return np.where(np.isfinite(distances.min(axis=0)), distances.min(axis=0), 0.0), np.where(
        np.isfinite(distances.min(axis=0)), distances.argmin(axis=0), NOTHING)


def test_ids(device: cl.Device) -> None:
    """Objects by their place in the scene, materials by that of their first use; −1 where nothing is."""
    _, which = first_hits()
    assert {FLOOR, BALL, WALL, LAMP, NOTHING} == set(np.unique(which))
    assert np.array_equal(picture(device).aovs["object_id"], which)
    materials = np.array([0, 1, 2, 0, -1])
    assert np.array_equal(picture(device).aovs["material_id"], materials[which])


def test_depth_and_position(device: cl.Device) -> None:
    """Metres from the camera, and where in the world. A root of a sphere that is met edge on has fewer digits."""
    distance, which = first_hits()
    layers = picture(device).aovs
    point = np.where((which >= 0)[..., None], EYE + distance[..., None] * rays(), 0.0)
    assert_exact(layers["depth"], distance, roundings=1 << 9)
    assert np.all(np.abs(layers["position"] - point) <= (1 << 9) * 2.0**-24 * distance[..., None])


def test_normal_points_to_the_viewer(device: cl.Device) -> None:
    distance, which = first_hits()
    point = EYE + distance[..., None] * rays()
    expected = np.zeros((HEIGHT, WIDTH, 3))
    expected[which == FLOOR] = (0.0, 1.0, 0.0)
    expected[which == BALL] = ((point - SPHERE) / RADIUS)[which == BALL]
    expected[(which == WALL) | (which == LAMP)] = (0.0, 0.0, 1.0)
    assert np.abs(picture(device).aovs["normal"] - expected).max() < (1 << 9) * 2.0**-24 * distance.max()


def test_albedo(device: cl.Device) -> None:
    _, which = first_hits()
    albedo = picture(device).aovs["albedo"]
    for item, value in ((FLOOR, 0.5), (BALL, (0.8, 0.2, 0.1)), (LAMP, 0.5), (NOTHING, 0.0)):
        assert_exact(albedo[which == item], value)
    assert set(np.unique(albedo[which == WALL])) == {np.float32(0.3), np.float32(0.7)}


def test_uv(device: cl.Device) -> None:
    """A rectangle's from corner to corner, a disk's over the square around it, a sphere's lat-long with ½ at +Z."""
    distance, which = first_hits()
    point = EYE + distance[..., None] * rays()
    found = picture(device).aovs["uv"]
    slack = (1 << 9) * 2.0**-24 * distance.max()
    wall = (point[..., :2] - (1.6, 1.01) + 1.0) / 2.0
    assert np.abs(found - wall)[which == WALL].max() < slack
    # The disk's own axes are its maker's choice: what they span is the square about it.
    radius = np.hypot(*(2.0 * found[which == LAMP] - 1.0).T) * 0.5
    assert np.abs(radius - np.hypot(point[..., 0] - 0.2, point[..., 1] - 2.2)[which == LAMP]).max() < slack
    n = (point - SPHERE) / RADIUS
    ball = np.stack([0.5 + np.arctan2(n[..., 0], n[..., 2]) / (2.0 * np.pi), 1.0 - np.arccos(np.clip(n[..., 1], -1.0, 1.0)) / np.pi], axis=-1)
    near_pole = np.hypot(n[..., 0], n[..., 2]) < 0.05
    assert np.abs(found - ball)[(which == BALL) & ~near_pole].max() < 8.0 * slack
    assert np.all(found[which == NOTHING] == 0.0)


def test_light_splits_into_what_is_emitted_direct_and_indirect(device: cl.Device) -> None:
    image = picture(device)
    distance, which = first_hits()
    layers = image.aovs
    assert_exact(layers["emission"] + layers["direct"] + layers["indirect"], image.pixels)
    assert_exact(layers["emission"][which == LAMP], (5.0, 4.0, 3.0))
    assert not layers["emission"][which != LAMP].any()
    in_front = (which == FLOOR) & ((EYE + distance[..., None] * rays())[..., 2] > 0.0)  # of the lamp, the ball's shadow aside
    assert np.mean(layers["direct"][in_front] > 0.0) > 0.8 and layers["indirect"][in_front].any()
    assert not any(layers[name][which == NOTHING].any() for name in ("direct", "indirect"))


def test_sample_count_and_variance(device: cl.Device) -> None:
    image = picture(device)
    assert np.all(image.aovs["sample_count"] == 16.0)
    assert np.array_equal(image.aovs["variance"], image.variance)
    _, which = first_hits()
    assert not image.variance[which == NOTHING].any()


def test_variance_is_that_of_the_mean(device: cl.Device) -> None:
    """Over many seeds, pictures scatter as each says: pixel by pixel, the mean of what is said less what is seen is 0 within its own scatter."""
    images = [render(device, scene(), seed=seed) for seed in range(12)]
    pixels = np.array([image.pixels for image in images], np.float64)
    said = np.mean([image.variance for image in images], axis=0, dtype=np.float64)
    seen = pixels.var(axis=0, ddof=1)
    # Relative to what is said, so that no bright pixel outweighs the others; the floor in the lamp's light has no heavy tails.
    distance, which = first_hits()
    part = (which == FLOOR) & (seen.max(axis=-1) > 0.0) & ((EYE + distance[..., None] * rays())[..., 2] > 0.5)
    ratio = seen[part] / said[part]
    assert len(ratio) > 100
    assert np.all(np.abs(ratio.mean(axis=0) - 1.0) < 5.0 * ratio.std(axis=0) / np.sqrt(len(ratio)))
