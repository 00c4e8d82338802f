"""Direct light on a Lambertian floor, against closed forms."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from lumiere.film.image import Image
from tests.render.scenes import POINT_FILTER, Json, assert_exact, assert_mean, from_above, ground, render

Array = np.ndarray

PIXELS, SIZE = 16, 2.0
ALBEDO = np.array([0.8, 0.5, 0.2])
FLOOR = {"type": "plane", "material": {"type": "lambert", "albedo": list(ALBEDO)}}

DARK = {
    "point": {"type": "point", "position": [0, 1, 0], "intensity": 0},
    "spot": {"type": "spot", "position": [0, 1, 0], "look_at": [0, 0, 0.1], "intensity": 0},
    "directional": {"type": "directional", "irradiance": 0},
    "sun": {"type": "directional", "irradiance": 0, "angle": 1},
    "environment": {"type": "environment", "radiance": 0},
}
"""One light of each kind that is no shape, of power 0: every scene here has the same features, and so the same programs."""


def floor_under(device: cl.Device, lights: dict[str, Json], spp: int, exact: bool = False) -> Image:
    film = {"width": PIXELS, "height": PIXELS} | ({"filter": POINT_FILTER} if exact else {})
    return render(device, {"camera": from_above(0.5, SIZE), "film": film, "sampler": {"type": "independent", "spp": spp}, "geometry": [FLOOR],
                           "lights": list((DARK | lights).values())})


def test_point_light(device: cl.Device) -> None:
    """L = ρ / π · I cosθ / d²."""
    position, intensity = np.array([0.4, 1.3, -0.2]), np.array([3.0, 2.0, 1.0])
    image = floor_under(device, {"point": DARK["point"] | {"position": list(position), "intensity": list(intensity)}}, 1, exact=True)
    to_light = position - ground(SIZE, PIXELS)
    distance = np.linalg.norm(to_light, axis=-1, keepdims=True)
    assert_exact(image.pixels, ALBEDO / np.pi * intensity * to_light[..., 1:2] / distance**3)


@pytest.mark.parametrize(("cone", "penumbra"), [(50.0, 0.3), (30.0, 1.0), (20.0, 0.0), (120.0, 0.5)])
def test_spot_light(device: cl.Device, cone: float, penumbra: float) -> None:
    """A point light times a smooth step between the cosines of the inner and the outer cone."""
    position, target = np.array([-0.6, 0.9, 0.3]), np.array([0.2, 0.0, 0.1])
    spot = DARK["spot"] | {"position": list(position), "look_at": list(target), "intensity": 5.0, "cone": cone, "penumbra": penumbra}
    image = floor_under(device, {"spot": spot}, 1, exact=True)
    to_light = position - ground(SIZE, PIXELS)
    distance = np.linalg.norm(to_light, axis=-1)
    axis = (target - position) / np.linalg.norm(target - position)
    cosine = -(to_light @ axis) / distance
    outer, inner = np.cos(np.radians(cone)), np.cos(np.radians(cone * (1.0 - penumbra)))
    t = np.clip((cosine - outer) / (inner - outer), 0.0, 1.0) if penumbra > 0.0 else (cosine >= outer).astype(float)
    expected = (ALBEDO / np.pi)[None, None] * (5.0 * t * t * (3.0 - 2.0 * t) * to_light[..., 1] / distance**3)[..., None]
    # The step multiplies the cosine's rounding by up to 1.5 / (inner − outer), and its value near 0 is t².
    slack = 4.0 * 2.0**-24 * (1.5 / (inner - outer) if penumbra > 0.0 else 1.0)
    away = np.abs(cosine - outer) > slack if penumbra == 0.0 else np.ones_like(cosine, bool)
    bound = 64.0 * 2.0**-24 * expected + slack * 8.0 * expected.max()
    assert np.all((np.abs(image.pixels - expected) <= bound)[away])
    assert np.any(expected == 0.0) == (cone < 100.0) and expected.max() > 0.0


def test_directional_light(device: cl.Device) -> None:
    """L = ρ / π · E cosθ, everywhere the same."""
    direction = np.array([0.3, -0.8, 0.5])
    light = DARK["directional"] | {"direction": list(direction), "irradiance": [1, 2, 3]}
    image = floor_under(device, {"directional": light}, 1, exact=True)
    assert_exact(image.pixels, ALBEDO / np.pi * (1.0, 2.0, 3.0) * 0.8 / np.linalg.norm(direction))


@pytest.mark.parametrize("angle", [0.53, 20.0, 60.0])
def test_sun(device: cl.Device, angle: float) -> None:
    """A disk in the sky, wholly over the horizon, gives what all its light would from its centre: E cosθ."""
    direction = np.array([0.3, -0.8, 0.5])
    sun = DARK["sun"] | {"direction": list(direction), "irradiance": [1, 2, 3], "angle": angle}
    image = floor_under(device, {"sun": sun}, 128)
    assert_mean(image, ALBEDO / np.pi * (1.0, 2.0, 3.0) * 0.8 / np.linalg.norm(direction))


def test_constant_environment(device: cl.Device) -> None:
    image = floor_under(device, {"environment": DARK["environment"] | {"radiance": [1, 2, 3]}}, 128)
    assert_mean(image, ALBEDO * (1.0, 2.0, 3.0))


def test_lights_add_up(device: cl.Device) -> None:
    """All at once, chosen at random: the sum of each alone."""
    position = np.array([0.1, 2.0, 0.2])
    lights = {"point": DARK["point"] | {"position": list(position), "intensity": [3, 0, 0]},
              "directional": DARK["directional"] | {"irradiance": [0.0, 1.0, 0.1]},
              "sun": DARK["sun"] | {"irradiance": [0.2, 0.0, 0.5], "angle": 10.0}, "environment": DARK["environment"] | {"radiance": [0.1, 0.1, 0.0]},
              "spot": DARK["spot"] | {"position": [0, 3, 0], "look_at": [0, 0, 0], "cone": 60, "penumbra": 0, "intensity": [0, 0, 2]}}
    image = floor_under(device, lights, 256)
    at = ground(SIZE, PIXELS)
    height = np.array([2.0, 3.0])
    distance2 = np.stack([np.sum((position - at) ** 2, axis=-1), np.sum((np.array([0.0, 3.0, 0.0]) - at) ** 2, axis=-1)])
    point, spot = height[:, None, None] / distance2**1.5
    irradiance = (np.array([0.2, 1.0, 0.6]) + np.pi * np.array([0.1, 0.1, 0.0]) + point[..., None] * np.array([3.0, 0.0, 0.0])
                  + spot[..., None] * np.array([0.0, 0.0, 2.0]))
    # Expectations are at the pixels' centres: over a pixel the point light's irradiance curves by less than a thousandth.
    assert_mean(image, ALBEDO / np.pi * irradiance, roundings=1 << 13)


# Lights that are shapes -----------------------------------------------------------------------------------------------------------------------

def polygon_factor(at: Array, corners: Array) -> Array:
    """Fraction of the light that leaves the floor at ``at`` (…, 3) and meets a polygon above it, of corners (n, 3) in order (Lambert 1760)."""
    towards = corners - at[..., None, :]
    towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
    following = np.roll(towards, -1, axis=-2)
    normal = np.cross(towards, following)
    angle = np.arccos(np.clip(np.sum(towards * following, axis=-1), -1.0, 1.0))
    return np.abs(np.sum(angle * normal[..., 1] / np.linalg.norm(normal, axis=-1), axis=-1)) / (2.0 * np.pi)


QUAD = [{"scale": [0.5, 0.3, 1]}, {"rotate": {"axis": [1, 0.3, 0], "angle": 70}}, {"translate": [0.2, 1.4, 0.1]}]
EMISSION = np.array([4.0, 2.0, 1.0])
EMITS = {"emission": list(EMISSION), "material": {"type": "lambert", "albedo": 0.0}}


def quad_corners() -> Array:
    corners = np.array([[-0.5, -0.3, 0.0], [0.5, -0.3, 0.0], [0.5, 0.3, 0.0], [-0.5, 0.3, 0.0]])
    axis, angle = np.array([1.0, 0.3, 0.0]) / np.sqrt(1.09), np.radians(70.0)
    k = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    rotation = np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k
    return corners @ rotation.T + (0.2, 1.4, 0.1)


def sphere_factor(at: Array, center: Array, radius: float) -> Array:
    """Of a sphere wholly over the horizon: (r / d)² cosθ."""
    towards = center - at
    distance = np.linalg.norm(towards, axis=-1)
    return radius**2 * towards[..., 1] / distance**3


def disk_factor(at: Array, center: Array, radius: float) -> Array:
    """Of a disk parallel to the floor (Howell, Menguc & Siegel 2010, configuration B-13)."""
    height, offset = center[1], np.hypot(at[..., 0] - center[0], at[..., 2] - center[2])
    h, r = height / offset, radius / offset
    z = 1.0 + h * h + r * r
    return 0.5 * (1.0 - (1.0 + h * h - r * r) / np.sqrt(z * z - 4.0 * r * r))


SHAPES = {
    "rectangle": {"type": "rectangle", "transform": QUAD},
    "sphere": {"type": "sphere", "position": [0.3, 1.5, -0.2], "radius": 0.4},
    "disk": {"type": "disk", "position": [-0.301, 1.2, 0.202], "normal": [0, -1, 0], "radius": 0.5},
}


def factor(shape: str, at: Array) -> Array:
    if shape == "rectangle":
        return polygon_factor(at, quad_corners())
    center = np.array(SHAPES[shape]["position"])
    return (sphere_factor if shape == "sphere" else disk_factor)(at, center, SHAPES[shape]["radius"])


MIDPOINTS = 4


def over_pixels(shape: str) -> Array:
    """(PIXELS, PIXELS) mean of the factor over each pixel, by midpoints."""
    fine = factor(shape, ground(SIZE, PIXELS * MIDPOINTS))
    return fine.reshape(PIXELS, MIDPOINTS, PIXELS, MIDPOINTS).mean(axis=(1, 3))


BURIED = [{"type": shape, "transform": [{"translate": [0, -1e4, 0]}]} for shape in ("box", "sphere", "disk")]
"""Shapes far under the floor, so that features are the same whatever shines, and those of test_path_length.py."""


def lit_by(device: cl.Device, lamps: list[Json], sampling: str = "mis", spp: int = 128, lights: tuple[Json, ...] = ()) -> Image:
    """The floor under what shines, below which the camera is."""
    return render(device, {"camera": from_above(0.4, SIZE), "film": {"width": PIXELS, "height": PIXELS},
                           "sampler": {"type": "independent", "spp": spp}, "integrator": {"light_sampling": sampling},
                           "geometry": [FLOOR, *BURIED, *lamps], "lights": [*lights, DARK["environment"]]})


each_sampling = pytest.mark.parametrize("sampling", ["mis", "light", "bsdf"])


@each_sampling
@pytest.mark.parametrize("shape", SHAPES)
def test_shape_as_light(device: cl.Device, shape: str, sampling: str) -> None:
    """L = ρ · L_light · form factor, however the light is found."""
    # By chance few rays meet the light.
    image = lit_by(device, [SHAPES[shape] | EMITS], sampling, spp=2048 if sampling == "bsdf" else 128)
    assert_mean(image, ALBEDO * EMISSION * over_pixels(shape)[..., None], roundings=1 << 11)


def test_area_light_is_a_shape_that_emits(device: cl.Device) -> None:
    """The light of type area gives the shape's picture; told by its power, it emits power / (π area) a side."""
    power = list(EMISSION * np.pi * 4.0 * np.pi * 0.4**2)
    lamp = {"type": "area", "position": [0.3, 1.5, -0.2], "radius": 0.4}
    by_power = lit_by(device, [], lights=(lamp | {"power": power},))
    by_radiance = lit_by(device, [], lights=(lamp | {"radiance": list(EMISSION)},))
    expected = ALBEDO * EMISSION * over_pixels("sphere")[..., None]
    assert_mean(by_radiance, expected, roundings=1 << 11)
    assert_mean(by_power, expected, roundings=1 << 11)


@pytest.mark.parametrize("sides", ["front", "both"])
def test_emission_sides(device: cl.Device, sides: str) -> None:
    """A disk that faces away from the floor lights it from both sides or not at all."""
    upwards = SHAPES["disk"] | {"normal": [0, 1, 0], "emission_sides": sides}
    image = lit_by(device, [upwards | EMITS])
    if sides == "front":
        assert not image.pixels.any()
    else:
        assert_mean(image, ALBEDO * EMISSION * over_pixels("disk")[..., None], roundings=1 << 11)
