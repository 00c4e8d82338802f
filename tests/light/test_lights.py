"""Lights on the device: are directions drawn with the density that is returned, is the density normalised, is the radiance where it should be?"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pyopencl as cl
import pytest
from scipy import stats

from tests.light.conftest import HEIGHT, WIDTH, sky_pixels
from tests.render.probe import Probe
from tests.statistics import SPHERE_HIGH, SPHERE_LOW, Cells, chi_square, mean_and_variance, rectangle_to_sphere, sidak, sphere_to_rectangle, z_test

Array = np.ndarray

SAMPLES = 200_000

SAMPLE = """
    light_sample_t s = NAME_sample(&scene, 0u, vload3(0, in_floats), (uint2)(in_uints[2u * item], in_uints[2u * item + 1u]));
    float3 w = s.infinite ? s.target : normalize(s.target - vload3(0, in_floats));
    vstore3(w, item, out_floats);
    vstore3(s.radiance, probe_count + item, out_floats);
    out_floats[6u * probe_count + item] = s.pdf;
    out_floats[7u * probe_count + item] = s.infinite ? INFINITY : length(s.target - vload3(0, in_floats));
    out_uints[item] = (uint)(s.delta != 0);
"""

INFINITE_DENSITY = """
    float3 w = vload3(item, in_floats);
    out_floats[4u * item] = NAME_pdf(&scene, 0u, w);
    vstore3(NAME_radiance(&scene, 0u, w), 0, out_floats + 4u * item + 1u);
"""

# The density with which `emitter_sample` finds what a ray from the reference meets first, as the renderer asks for it.
EMITTER_DENSITY = """
    ray_t ray;
    ray.o = vload3(0, in_floats);
    ray.d = vload3(1u + item, in_floats);
    ray.t_max = INFINITY;
    hit_t hit;
    vstore3((float3)(0.0f), item, out_floats);
    if (trace_nearest(&scene, &ray, &hit)) {
        surface_t surface = surface_at(&scene, &ray, &hit);
        vstore3((float3)(emitter_pdf(&scene, hit.primitive, ray.o, &surface), fabs(dot(surface.ng, ray.d)), hit.t), item, out_floats);
    }
"""


class Samples:
    """What a light's sampling returned: unit directions (n, 3), radiance (n, 3), densities and distances (n,)."""

    def __init__(self, probe: Probe, count: int, reference: Array, seed: int) -> None:
        bits = np.random.default_rng(seed).integers(0, 1 << 32, (count, 2), dtype=np.uint32)
        out, delta = probe(count, floats=np.append(reference, 0.0), uints=bits, out_floats=8, out_uints=1)
        out = out.ravel().astype(np.float64)
        self.w, self.radiance = out[:3 * count].reshape(count, 3), out[3 * count:6 * count].reshape(count, 3)
        self.pdf, self.distance, self.delta = out[6 * count:7 * count], out[7 * count:], bool(delta.any())


def scene_of(light: dict[str, Any] | None, *shapes: dict[str, Any]) -> dict[str, Any]:
    return {"scene": {"geometry": list(shapes) or [{"type": "sphere", "position": [0, 0, -50]}], "lights": [light] if light else []}}


def frame_about(axis: Array) -> Array:
    """(3, 3) whose rows are two tangents and the unit ``axis``."""
    axis = np.asarray(axis, np.float64) / np.linalg.norm(axis)
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    u = np.cross(helper, axis)
    u /= np.linalg.norm(u)
    return np.stack([u, np.cross(axis, u), axis])


# The environment ------------------------------------------------------------------------------------------------------------------------------

ROTATION = {"transform": [{"rotate": {"axis": [1, 2, -1], "angle": 77}}]}


def rotation_matrix() -> Array:
    axis, angle = np.array([1.0, 2.0, -1.0]) / np.sqrt(6.0), np.radians(77.0)
    k = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k


def lat_long(u: Array, v: Array) -> Array:
    """Unit vectors of picture coordinates: u to the right from 0 to 1 with ½ at −Z, v downwards from +Y (the scene format's convention)."""
    phi, theta = 2.0 * np.pi * (u - 0.5), np.pi * v
    return np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)], -1)


def picture_of(w: Array) -> tuple[Array, Array]:
    """The inverse of ``lat_long``."""
    return 0.5 + np.arctan2(w[:, 0], -w[:, 2]) / (2.0 * np.pi), np.arctan2(np.hypot(w[:, 0], w[:, 2]), w[:, 1]) / np.pi


def bilinear(u: Array, v: Array) -> Array:
    """The sky's radiance, looked up bilinearly: the columns wrap, the rows end."""
    pixels = sky_pixels().astype(np.float64)
    x, y = u * WIDTH - 0.5, v * HEIGHT - 0.5
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - x0)[:, None], (y - y0)[:, None]
    at = lambda i, j: pixels[np.clip(j, 0, HEIGHT - 1), i % WIDTH]  # noqa: E731
    return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x0 + 1, y0)) + fy * ((1 - fx) * at(x0, y0 + 1) + fx * at(x0 + 1, y0 + 1))


@cache
def _environment(device: cl.Device, sky: str, rotated: bool, body: str) -> Probe:
    light = {"type": "environment", "file": sky} | (ROTATION if rotated else {})
    return Probe(device, scene_of(light), "shade", body.replace("NAME", "environment_image"))


each_rotation = pytest.mark.parametrize("rotated", [False, True], ids=["upright", "rotated"])


@each_rotation
def test_environment_shows_the_picture(device: cl.Device, sky: str, rotated: bool) -> None:
    """Centre column −Z, columns to the viewer's right, row 0 up, bilinear in between; a transform turns picture and all."""
    u, v = np.random.default_rng(3).random((2, 20_000))
    world = lat_long(u, v) @ (rotation_matrix().T if rotated else np.eye(3))
    out, _ = _environment(device, sky, rotated, INFINITE_DENSITY)(len(world), floats=world, out_floats=4)
    # The direction is rounded, which moves the lookup by a few 1e-7 of the picture, further in u towards the poles: moving it in float64 says
    # how much that can change the value.
    step = 2e-6
    values = bilinear(u, v)
    slack = sum(np.abs(bilinear(u + du, np.clip(v + dv, 0.0, 1.0)) - values) for du, dv in
                ((step / np.sin(np.pi * v), 0.0), (-step / np.sin(np.pi * v), 0.0), (0.0, step), (0.0, -step)))
    assert np.all(np.abs(out[:, 1:] - values) <= slack + 1e-5 * values + 1e-7)


@each_rotation
def test_environment_samples_follow_the_density(device: cl.Device, sky: str, rotated: bool) -> None:
    """χ² over the picture's texels, in each of which the density is a constant over the angles, and over the places within them."""
    s = Samples(_environment(device, sky, rotated, SAMPLE), SAMPLES, np.zeros(3), seed=1)
    local = s.w @ (rotation_matrix() if rotated else np.eye(3))
    u, v = picture_of(local)
    texel = np.floor(v * HEIGHT).astype(int) * WIDTH + np.clip(np.floor(u * WIDTH).astype(int), 0, WIDTH - 1)
    centres_v, centres_u = (np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5) / np.array([HEIGHT, WIDTH])[:, None, None]
    centres = lat_long(centres_u.ravel(), centres_v.ravel()) @ (rotation_matrix().T if rotated else np.eye(3))
    out, _ = _environment(device, sky, rotated, INFINITE_DENSITY)(len(centres), floats=centres, out_floats=4)
    measure = 2.0 * np.pi**2 / (WIDTH * HEIGHT) * np.sin(np.pi * centres_v.ravel())
    probability = out[:, 0].astype(np.float64) * measure
    assert abs(probability.sum() - 1.0) < 1e-5  # of 288 float32 terms
    assert chi_square(np.bincount(texel, minlength=WIDTH * HEIGHT).astype(float), SAMPLES * probability) > sidak(1e-3, 4)
    place = np.floor(4.0 * ((v * HEIGHT) % 1.0)) * 4.0 + np.floor(4.0 * ((u * WIDTH) % 1.0))
    dim = texel != 3 * WIDTH + 16  # nearly all samples are in the bright pixel, whose float32 directions are fine enough too, but test the rest
    for chosen in (dim, ~dim):
        counts = np.bincount(place[chosen].astype(int), minlength=16).astype(float)
        assert chi_square(counts, np.full(16, counts.sum() / 16.0)) > sidak(1e-3, 4)


@each_rotation
def test_environment_density_is_what_was_sampled(device: cl.Device, sky: str, rotated: bool) -> None:
    s = Samples(_environment(device, sky, rotated, SAMPLE), SAMPLES, np.zeros(3), seed=2)
    out, _ = _environment(device, sky, rotated, INFINITE_DENSITY)(SAMPLES, floats=s.w, out_floats=4)
    u, v = picture_of(s.w @ (rotation_matrix() if rotated else np.eye(3)))
    # On a texel's edge the rounded direction may lie in its neighbour.
    inside = np.minimum(np.abs((u * WIDTH + 0.5) % 1.0 - 0.5), np.abs((v * HEIGHT + 0.5) % 1.0 - 0.5)) > 1e-4
    assert inside.mean() > 0.99
    assert np.allclose(out[inside, 0], s.pdf[inside], rtol=2e-5 / np.sin(np.pi * v[inside]).min())
    assert np.all(s.pdf > 0.0)


def test_environment_weights_average_to_the_irradiance(device: cl.Device, sky: str) -> None:
    """The mean of L / pdf is ∫ L dω, that of its square ∫ L² / pdf dω: by quadrature, although one pixel is 1e5 times as bright as the others."""
    s = Samples(_environment(device, sky, False, SAMPLE), SAMPLES, np.zeros(3), seed=3)
    fine = 16
    v, u = (np.mgrid[0:HEIGHT * fine, 0:WIDTH * fine] + 0.5) / np.array([HEIGHT * fine, WIDTH * fine])[:, None, None]
    edges = np.cos(np.linspace(0.0, np.pi, HEIGHT * fine + 1))
    solid_angle = np.repeat(edges[:-1] - edges[1:], WIDTH * fine) * 2.0 * np.pi / (WIDTH * fine)
    out, _ = _environment(device, sky, False, INFINITE_DENSITY)(u.size, floats=lat_long(u.ravel(), v.ravel()), out_floats=4)
    radiance = bilinear(u.ravel(), v.ravel())
    with np.errstate(divide="ignore", invalid="ignore"):
        square = np.where(radiance > 0.0, np.square(radiance) / out[:, :1], 0.0)
    weights = s.radiance / s.pdf[:, None]
    for values, integrand in ((weights, radiance), (np.square(weights), square)):
        integral = (integrand * solid_angle[:, None]).sum(axis=0)
        mean, variance = mean_and_variance(values)
        # The quadrature's own error: 16 × 16 midpoints in each texel.
        assert np.all(z_test(mean - integral, variance + (1e-3 * integral) ** 2) > sidak(1e-3, 6))


def test_constant_environment_is_uniform(device: cl.Device) -> None:
    scene = scene_of({"type": "environment", "radiance": [1, 2, 3]})
    s = Samples(Probe(device, scene, "shade", SAMPLE.replace("NAME", "environment")), SAMPLES, np.zeros(3), seed=4)
    cells = Cells.around(sphere_to_rectangle(s.w[:1000]), SPHERE_LOW, SPHERE_HIGH)
    area = np.zeros(len(cells))
    np.add.at(area, cells.owner, np.prod(cells.high - cells.low, axis=1))
    assert chi_square(cells.count(sphere_to_rectangle(s.w[1000:])), (SAMPLES - 1000) * area / (4.0 * np.pi)) > 1e-3
    assert np.allclose(s.pdf, 0.25 / np.pi, rtol=1e-6)
    assert np.allclose(s.radiance, (1.0, 2.0, 3.0))


# The sun --------------------------------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("angle", [0.53, 20.0, 170.0])
def test_sun_is_a_uniform_disk(device: cl.Device, angle: float) -> None:
    direction = np.array([0.3, -0.8, 0.5])
    scene = scene_of({"type": "directional", "direction": list(direction), "angle": angle, "irradiance": 3.0})
    s = Samples(Probe(device, scene, "shade", SAMPLE.replace("NAME", "sun")), SAMPLES, np.zeros(3), seed=5)
    half = np.radians(angle) / 2.0
    solid_angle = 4.0 * np.pi * np.sin(half / 2.0) ** 2
    t_phi = sphere_to_rectangle(s.w @ frame_about(-direction).T)
    cells = Cells.around(t_phi[:20_000], np.array([0.0, -np.pi]), np.array([solid_angle / (2.0 * np.pi), np.pi]), depth=6)
    area = np.zeros(len(cells))
    np.add.at(area, cells.owner, np.prod(cells.high - cells.low, axis=1))
    # A direction's rounding, 1e-7, moves it across the edge of a disk of this radius at most so often.
    assert np.mean(t_phi[:, 0] > solid_angle / (2.0 * np.pi)) < 1e-6 / half + 1e-5
    assert chi_square(cells.count(t_phi[20_000:]), (SAMPLES - 20_000) * area / solid_angle) > sidak(1e-3, 3)
    assert np.allclose(s.pdf, 1.0 / solid_angle, rtol=1e-6)
    out, _ = Probe(device, scene, "shade", INFINITE_DENSITY.replace("NAME", "sun"))(SAMPLES, floats=s.w, out_floats=4)
    assert np.mean(out[:, 1] == 0.0) < 1e-6 / half + 1e-5
    assert np.allclose(out[:, 0], s.pdf, rtol=1e-6)
    # Irradiance on a facing surface: the mean of L cosθ / pdf.
    mean, variance = mean_and_variance(s.radiance[:, 0] * (s.w @ (-direction / np.linalg.norm(direction))) / s.pdf)
    assert z_test(mean - 3.0, variance + (3e-6 * 3.0) ** 2) > sidak(1e-3, 3)


# Shapes that emit -----------------------------------------------------------------------------------------------------------------------------

TRIANGLE = {"type": "mesh", "vertices": [[-1.0, -0.4, 0.0], [1.3, -0.6, 0.2], [0.1, 1.1, -0.3]], "faces": [[0, 1, 2]]}
DISK = {"type": "disk", "position": [0, 0, 0], "normal": [0.2, -0.3, 1], "radius": 1.2}
ELLIPSE = {"type": "disk", "transform": [{"scale": [1.5, 0.4, 1]}, {"rotate": {"axis": [1, 0, 0], "angle": 20}}]}
SPHERE = {"type": "sphere", "radius": 1.0}
ELLIPSOID = {"type": "sphere", "transform": [{"scale": [1.5, 0.4, 0.8]}, {"rotate": {"axis": [1, 2, 0], "angle": 40}}]}

EMITTERS = {
    "triangle, near": (TRIANGLE, (0.1, 0.0, 0.05)),
    "triangle, far": (TRIANGLE, (3.0, 4.0, 12.0)),
    "triangle, grazing": (TRIANGLE, (4.0, 0.3, 0.1)),
    "triangle, behind": (TRIANGLE, (0.2, -0.4, -2.0)),
    "disk, near": (DISK, (0.3, 0.2, 0.1)),
    "disk, far": (DISK, (-5.0, 3.0, 9.0)),
    "ellipse": (ELLIPSE, (0.5, 0.7, 1.0)),
    "sphere, outside": (SPHERE, (1.0, 2.0, -2.0)),
    "sphere, near": (SPHERE, (0.0, 0.6006, 0.8008)),
    "sphere, far": (SPHERE, (500.0, -700.0, 500.0)),
    "sphere, inside": (SPHERE, (0.3, 0.5, -0.2)),
    "sphere, just inside": (SPHERE, (0.0, -0.594, 0.792)),
    "ellipsoid, outside": (ELLIPSOID, (1.0, 2.0, -2.0)),
    "ellipsoid, inside": (ELLIPSOID, (0.3, 0.1, -0.2)),
}


@cache
def _emitter(device: cl.Device, name: str, body: str) -> Probe:
    shape = EMITTERS[name][0] | {"emission": 1.0, "emission_sides": "both"}
    return Probe(device, scene_of(None, shape), "shade", body)


def _samples(device: cl.Device, name: str, count: int, reference: Array, seed: int) -> Samples:
    return Samples(_emitter(device, name, SAMPLE.replace("NAME_sample(&scene, 0u", "emitter_sample(&scene, 0u")), count, reference, seed)


def _densities(device: cl.Device, name: str, reference: Array, w: Array) -> Array:
    """(n, 3) float64: the density of each direction, the cosine at the shape, and the distance."""
    out, _ = _emitter(device, name, EMITTER_DENSITY)(len(w), floats=np.concatenate([reference, w.ravel()]), out_floats=3)
    return out.astype(np.float64)


@pytest.mark.parametrize("name", EMITTERS)
def test_emitter_samples_follow_the_density(device: cl.Device, name: str) -> None:
    """χ² of directions from a reference point against the density that a ray which meets the shape is told; the density's integral is 1.

    An ellipsoid is sampled on its far side too, where rays do not come: those samples are left out. The density ends at a silhouette, so its
    integrals over the cells are taken by Monte Carlo, and their variance joins the counts'.
    """
    reference = np.array(EMITTERS[name][1], np.float32).astype(np.float64)
    s = _samples(device, name, SAMPLES, reference, seed=6)
    assert np.all(s.pdf > 0.0)
    frame = frame_about(s.w[:1000].mean(axis=0) if "inside" not in name else np.array([0.2, 0.3, 1.0]))
    t_phi = sphere_to_rectangle(s.w @ frame.T)
    seen = np.ones(SAMPLES, bool)
    if name.startswith("ellipsoid"):
        seen = np.abs(_densities(device, name, reference, s.w)[:, 2] - s.distance) < 1e-3
    pilot, rest = t_phi[:20_000][seen[:20_000]], t_phi[20_000:][seen[20_000:]]
    # The part of the sphere that the shape fills, with a margin: its silhouette lies inside the cells.
    low, high = SPHERE_LOW.copy(), SPHERE_HIGH.copy()
    if t_phi[:, 0].min() > 0.0:
        low[0], high[0] = 0.0, min(1.0, 1.02 * t_phi[:, 0].max())
    cells = Cells.around(pilot, low, high, depth=6)
    draws = -(-500_000 // len(cells.low))
    at = cells.low[:, None] + (cells.high - cells.low)[:, None] * np.random.default_rng(9).random((len(cells.low), draws, 2))
    density = _densities(device, name, reference, rectangle_to_sphere(at.reshape(-1, 2)) @ frame)[:, 0].reshape(len(cells.low), draws)
    size = np.prod(cells.high - cells.low, axis=1)
    integral, variance = np.zeros(len(cells)), np.zeros(len(cells))
    np.add.at(integral, cells.owner, size * density.mean(axis=1))
    np.add.at(variance, cells.owner, np.square(size) * density.var(axis=1, ddof=1) / draws)
    level = sidak(1e-3, 2 * len(EMITTERS))
    assert z_test(integral.sum() - seen.mean(), variance.sum() + seen.var() / SAMPLES + 1e-5**2) > level
    n = SAMPLES - 20_000
    z2 = np.square(cells.count(rest) - n * integral) / (n * integral + n * n * variance)
    assert stats.chi2.sf(z2.sum(), len(cells) - 1) > level


@pytest.mark.parametrize("name", EMITTERS)
def test_emitter_density_is_what_was_sampled(device: cl.Device, name: str) -> None:
    """The density of a sample is that of the ray that meets it: multiple importance sampling compares the two."""
    reference = np.array(EMITTERS[name][1], np.float32).astype(np.float64)
    s = _samples(device, name, 20_000, reference, seed=7)
    density, cosine, distance = _densities(device, name, reference, s.w).T
    met = density > 0.0
    assert met.mean() > 0.998  # a few graze the silhouette
    met &= np.abs(distance - s.distance) < 1e-3 * (1.0 + distance)  # and from an ellipsoid's far side no ray comes
    assert met.mean() > (0.3 if name.startswith("ellipsoid") else 0.998)
    # Rounding moves the point by a few 2^-24 of the shapes' size, 1, and 1 / cosine as much along the shape; by that the distance changes, and with
    # the shape's curvature the cosine.
    curvature = {"sphere": 1.0, "ellipsoid": 1.5 / 0.4**2}.get(name.partition(",")[0], 0.0)
    bound = 64.0 * 2.0**-24 / cosine[met] * (1.0 + 1.0 / distance[met] + curvature / cosine[met])
    assert np.mean(np.abs(density[met] / s.pdf[met] - 1.0) < bound) > 0.998


def test_lights_are_chosen_with_the_probability_that_is_divided_out(device: cl.Device, sky: str) -> None:
    """The density that light_sample returns is the light's own times how often it is chosen."""
    scene = {"scene": {
        "geometry": [SPHERE | {"emission": 2.0}, DISK | {"position": [4, 0, 0], "emission": [0, 0, 0.5]}, {"type": "sphere", "position": [0, 9, 0]}],
        "lights": [{"type": "point", "position": [5, 5, 5], "intensity": 3.0}, {"type": "environment", "radiance": 0.01},
                   {"type": "directional", "irradiance": 0.0}, {"type": "directional", "angle": 5.0, "irradiance": 1.0},
                   {"type": "spot", "position": [2, 3, 4], "look_at": [0, 9, 0], "intensity": 2.0}]}}
    body = """
    light_sample_t s = light_sample(&scene, vload3(0, in_floats), (uint2)(in_uints[2u * item], in_uints[2u * item + 1u]));
    discrete_t chosen = discrete_sample(scene.light_cdf, scene.render->light_count, in_uints[2u * item]);
    out_uints[item] = chosen.index;
    out_floats[2u * item] = s.pdf;
    out_floats[2u * item + 1u] = chosen.probability;
    """
    bits = np.random.default_rng(8).integers(0, 1 << 32, (SAMPLES, 2), dtype=np.uint32)
    probe = Probe(device, scene, "shade", body)
    out, index = probe(SAMPLES, floats=np.array([0.0, 7.5, 0.5, 0.0]), uints=bits, out_floats=2, out_uints=1)
    count = int(probe.buffers.arrays["render"][1]["light_count"][0])
    probability = np.zeros(count)
    probability[index[:, 0]] = out[:, 1]
    assert count == 7 and np.count_nonzero(probability) == 6  # the light of power 0 is never chosen
    assert abs(probability.sum() - 1.0) < 1e-6
    assert chi_square(np.bincount(index[:, 0], minlength=count).astype(float), SAMPLES * probability) > 1e-3
    assert np.all(out[:, 0] >= 0.0)
    delta = out[index[:, 0] == 2 + list(dict.fromkeys(["point", "environment", "directional", "sun", "spot"])).index("point")]
    assert np.allclose(delta[:, 0], delta[:, 1])
