"""Random walks in bodies: what comes out of them against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyopencl as cl
import pytest
from scipy import integrate

import lumiere
import lumiere.rendering
from lumiere.compile.scene import compile_scene
from lumiere.wavefront.policy import policy_for
from tests.render.scenes import Json, assert_mean, index_of, render

WHITE = [{"type": "environment", "radiance": 1}]
HEAD_ON = {"type": "orthographic", "position": [0, 0, 9], "look_at": [0, 0, 0], "height": 1}
WALK = {"max_depth": 1000, "russian_roulette_depth": 5}


def wax(**keys: object) -> Json:
    return {"type": "subsurface", "ior": 1.0, "roughness": 0.0, **keys}


def block(thickness: float, material: Json) -> Json:
    return {"type": "box", "min": [-1e3, -1e3, -thickness], "max": [1e3, 1e3, 0], "material": material}


def seen(device: cl.Device, material: Json, thickness: float, spp: int = 512, **keys: object) -> lumiere.Image:
    """The middle of a slab, head on, under a white sky."""
    return render(device, {"camera": HEAD_ON, "film": {"width": 8, "height": 8}, "sampler": {"type": "independent", "spp": spp}, "integrator": WALK,
                           "geometry": [block(thickness, material)], "lights": WHITE} | keys)


@pytest.mark.parametrize("thickness", [0.5, 2.0])
def test_what_only_absorbs(device: cl.Device, thickness: float) -> None:
    """exp(−σt d) of the sky behind, channel by channel (Beer)."""
    radius = np.array([0.5, 1.0, 4.0])
    image = seen(device, wax(albedo=0.0, radius=list(radius)), thickness, spp=1024)
    assert_mean(image, np.exp(-thickness / radius))


def escaping(optical_depth: float, cosine: float) -> float:
    """Of light that starts inside a slab so deep below one side: the part that reaches it along a direction without meeting anything."""
    return float(np.exp(-optical_depth / cosine))


def single_scattering(depth: float) -> float:
    """Radiance head on of a slab of this optical depth, of an albedo so small that only one event matters, per albedo, under a white sky: the sky
    behind is left out. ∫ e^(−t) ∫ p L dω dt with an isotropic phase function: half from above, e^(−t / μ), half from below, e^(−(d − t) / μ)."""
    inner = lambda t: 0.5 * integrate.quad(lambda mu: escaping(t, mu) + escaping(depth - t, mu), 0.0, 1.0)[0]  # noqa: E731
    return float(integrate.quad(lambda t: np.exp(-t) * inner(t), 0.0, depth)[0])


def test_single_scattering_of_a_thin_slab(device: cl.Device) -> None:
    """Even a dark body's second events count for little: at an event's albedo of α they add less than α² of its depth."""
    color, depth = 0.02, 0.5
    s = 4.09712 + 4.20863 * color - np.sqrt(9.59217 + 41.6808 * color + 17.7126 * color**2)
    albedo = 1.0 - s * s
    image = seen(device, wax(albedo=color, radius=1.0), depth, spp=8192)
    once = np.exp(-depth) + albedo * single_scattering(depth)
    twice_at_most = (albedo * depth) ** 2
    mean, error = image.pixels.mean(axis=(0, 1)).astype(float), np.sqrt(image.variance.mean() / 64)
    assert np.all(mean > once - 4.0 * error) and np.all(mean < once + twice_at_most + 4.0 * error), f"found {mean} ± {error}, expected {once}"


def event_albedo(color: np.ndarray) -> np.ndarray:
    """Of one isotropic event, by the inverted fit of van de Hulst."""
    s = 4.09712 + 4.20863 * color - np.sqrt(9.59217 + 41.6808 * color + 17.7126 * color**2)
    return 1.0 - s * s


def half_space(albedo: float) -> float:
    """Head-on radiance of an isotropically scattering half-space under a white sky: 1 − √(1 − α) H(1) (Chandrasekhar 1960, §88), H by iteration of
    1 / H(μ) = √(1 − α) + α/2 ∫ μ' H(μ') / (μ + μ') dμ'."""
    nodes, weights = np.polynomial.legendre.leggauss(64)
    mu, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    h = np.ones_like(mu)
    inverse = lambda at: np.sqrt(1.0 - albedo) + 0.5 * albedo * (weights * mu * h / (at[:, None] + mu)).sum(axis=1)  # noqa: E731
    for _ in range(2000):
        h = 1.0 / inverse(mu)
    return float(1.0 - np.sqrt(1.0 - albedo) / inverse(np.ones(1))[0])


@pytest.mark.parametrize("color", [[0.2, 0.5, 0.8], [0.9, 0.95, 0.1]])
def test_half_space_head_on(device: cl.Device, color: list[float]) -> None:
    image = seen(device, wax(albedo=color, radius=1e-3), 10.0, spp=1024)
    assert_mean(image, np.array([half_space(a) for a in event_albedo(np.array(color))]))


@pytest.mark.parametrize("g", [0.0, 0.5])
def test_a_thick_body_has_the_albedo_asked_for(device: cl.Device, g: float) -> None:
    """The disk of a ball holds all directions by their projected area: under a white sky its mean is the albedo that the fit is for, within 0.012."""
    color = np.array([0.2, 0.5, 0.9])
    ball = {"type": "sphere", "radius": 0.45, "material": wax(albedo=list(color), radius=3e-4, g=g)}
    image = render(device, {"camera": HEAD_ON, "film": {"width": 32, "height": 32}, "sampler": {"type": "independent", "spp": 128},
                            "integrator": WALK, "geometry": [ball], "lights": WHITE})
    covered = np.pi * 0.45**2
    found, error = (image.pixels.mean(axis=(0, 1)) - (1.0 - covered)) / covered, np.sqrt(image.variance.mean() / 1024) / covered
    assert np.all(np.abs(found - color) < 0.012 + 4.0 * error), f"found {found} ± {error}"


@pytest.mark.parametrize(("keys", "tolerance"), [({}, 0.0), ({"ior": 1.4}, 0.0), ({"ior": 1.4, "roughness": 0.4}, 0.012), ({"radius": 0.05, "g": 0.8}, 0.0)],
                         ids=["no surface", "smooth", "rough", "thin, forward"])
def test_white_furnace(device: cl.Device, keys: Json, tolerance: float) -> None:
    """A white body under a white sky is invisible."""
    ball = {"type": "sphere", "radius": 0.45, "material": wax(albedo=1.0, radius=[0.02, 0.1, 1.0]) | keys}
    image = render(device, {"camera": HEAD_ON, "film": {"width": 16, "height": 16}, "sampler": {"type": "independent", "spp": 64},
                            "integrator": WALK, "geometry": [ball], "lights": WHITE})
    mean, error = image.pixels.mean(axis=(0, 1)), np.sqrt(image.variance.mean(axis=(0, 1)) / 256)
    assert np.all(np.abs(mean - 1.0) < 4.0 * error + tolerance + 1e-4), f"found {mean} ± {error}"


SMALL = {"camera": HEAD_ON, "film": {"width": 16, "height": 16}, "integrator": {"max_depth": 64},
         "geometry": [{"type": "sphere", "radius": 0.4, "material": {"type": "subsurface", "albedo": [0.9, 0.5, 0.3], "radius": [0.3, 0.1, 0.05]}},
                      {"type": "sphere", "position": [0.4, 0.4, -0.2], "radius": 0.2}],
         "lights": [{"type": "point", "position": [2, 3, 4], "intensity": 60}]}


def test_scale_does_not_matter(device: cl.Device) -> None:
    small = {"camera": HEAD_ON | {"position": [0, 0, 9e-3], "height": 1e-3}, "geometry": [
        {"type": "sphere", "radius": 4e-4, "material": {"type": "subsurface", "albedo": [0.9, 0.5, 0.3], "radius": [3e-4, 1e-4, 5e-5]}},
        {"type": "sphere", "position": [4e-4, 4e-4, -2e-4], "radius": 2e-4}],
        "lights": [{"type": "point", "position": [2e-3, 3e-3, 4e-3], "intensity": 60e-6}]}
    sampler = {"type": "independent", "spp": 256}
    large, small = render(device, SMALL | {"sampler": sampler}), render(device, SMALL | small | {"sampler": sampler | {"seed": 1}})
    difference = (large.pixels.astype(float) - small.pixels).mean(axis=(0, 1))
    z = difference / np.sqrt((large.variance + small.variance).mean(axis=(0, 1)) / 256)
    assert np.all(np.abs(z) < 4.0), z


def test_schedule_does_not_matter(device: cl.Device, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = lumiere.render({"scene": SMALL}, spp=4, device=index_of(device))
    assert usual.pixels.mean() > 0.0
    for changes in ({"slots": 512}, {"slots": 1024, "compacted": True, "groups_leave": False}):
        monkeypatch.setattr(lumiere.rendering, "policy_for", lambda *a, changes=changes, **k: replace(policy_for(*a, **k), **changes))
        assert np.array_equal(lumiere.render({"scene": SMALL}, spp=4, device=index_of(device)).pixels, usual.pixels), changes


def test_only_bodies_that_scatter_bring_the_stage() -> None:
    plain = compile_scene(lumiere.load({"scene": SMALL | {"geometry": SMALL["geometry"][1:]}}))
    assert not plain.features.subsurface
    assert compile_scene(lumiere.load({"scene": SMALL})).features.subsurface


def principled_ball(**keys: object) -> Json:
    return {"camera": HEAD_ON, "film": {"width": 24, "height": 24}, "sampler": {"type": "independent", "spp": 256}, "integrator": WALK,
            "geometry": [{"type": "sphere", "radius": 0.45, "material": {"type": "principled", "base_color": [0.9, 0.5, 0.2], **keys}}],
            "lights": [{"type": "environment", "radiance": 0.5}, {"type": "directional", "direction": [-1, -1, -1], "irradiance": 2}]}


def test_principled_with_a_short_way_is_its_base(device: cl.Device) -> None:
    """Where light comes out next to where it went in, a principled body looks as without subsurface, within the fit of its color."""
    base = render(device, principled_ball())
    below = render(device, principled_ball(subsurface=1.0, subsurface_radius=1e-5))
    found, expected = below.pixels.mean(axis=(0, 1)), base.pixels.mean(axis=(0, 1))
    error = np.sqrt((base.variance + below.variance).mean(axis=(0, 1)) / 576)
    assert np.all(np.abs(found - expected) < 4.0 * error + 0.012), f"found {found} ± {error}, expected {expected}"


def test_principled_furnace(device: cl.Device) -> None:
    scene = principled_ball(base_color=1.0, subsurface=0.7, subsurface_radius=[0.2, 0.05, 0.01], clearcoat=0.5) | {"lights": WHITE}
    image = render(device, scene)
    mean, error = image.pixels.mean(axis=(0, 1)), np.sqrt(image.variance.mean(axis=(0, 1)) / 576)
    assert np.all(np.abs(mean - 1.0) < 4.0 * error + 0.012), f"found {mean} ± {error}"
