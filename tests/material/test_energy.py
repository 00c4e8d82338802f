"""What rough surfaces give back: white ones reflect everything, and nobody reflects more than that."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from lumiere.bsdf import MATERIALS, Material
from lumiere.bsdf.principled import Principled
from tests.bsdf.harness import bsdf_of, direction, pack, uniform
from tests.bsdf.study import seed
from tests.statistics import chi_square, mean_and_variance

WHITE = (1.0, 1.0, 1.0)
TOLERANCE = 0.005
ROUGHNESSES = (0.05, 0.3, 0.5, 0.8, 1.0)


def make(kind: str, **values: object) -> Material:
    return MATERIALS.kinds()[kind](**values)


FURNACES = (
    [make("conductor", roughness=r) for r in ROUGHNESSES]
    + [make("dielectric", roughness=r, ior=ior) for r in ROUGHNESSES for ior in (0.7, 1.05, 1.2, 1.5, 2.4)]
    + [make("plastic", albedo=WHITE, roughness=r, ior=ior) for r in ROUGHNESSES for ior in (1.2, 1.5, 2.4)]
    + [Principled(base_color=WHITE, metallic=m, roughness=r, transmission=t)
       for r in ROUGHNESSES for m, t in ((0.0, 0.0), (1.0, 0.0), (0.5, 0.0), (0.0, 1.0))]
    + [Principled(base_color=WHITE, roughness=0.4, specular=s, specular_tint=tint) for s in (0.0, 0.1, 1.0) for tint in (WHITE, (1.0, 0.3, 0.1))]
)
LAYERS = (
    {"clearcoat": 1.0}, {"clearcoat": 0.5, "clearcoat_roughness": 0.6}, {"sheen": WHITE}, {"sheen": WHITE, "sheen_roughness": 1.0},
    {"sheen": (1.0, 0.5, 0.0), "clearcoat": 1.0, "metallic": 0.5})


def describe(material: Material) -> str:
    return "-".join([material.type, *(str(v) for v in material.device_values().values() if not isinstance(v, tuple))])


def energy(device: cl.Device, material: Material, wo: np.ndarray, count: int = 1 << 16) -> tuple[np.ndarray, np.ndarray]:
    """(3,) fraction of the light that is scattered, and its variance; without the 1 / η² of what crosses."""
    bsdf = bsdf_of(device, material)
    s = bsdf.sample(pack(material), wo, uniform(np.random.default_rng(seed(repr(material), *wo)), count))
    return mean_and_variance(s.weight * (s.eta**2)[:, None])


@pytest.mark.parametrize("material", FURNACES, ids=describe)
def test_white_furnace(device: cl.Device, material: Material) -> None:
    views = [direction(theta, 40.0) for theta in (0.0, 40.0, 70.0, 85.0)]
    for wo in views + ([] if material.reflective else [-w for w in views]):
        mean, variance = energy(device, material, wo)
        assert np.all(np.abs(mean - 1.0) < TOLERANCE + 5.0 * np.sqrt(variance))


@pytest.mark.parametrize("layers", LAYERS, ids=str)
def test_layers_make_no_energy_and_lose_little(device: cl.Device, layers: dict[str, object]) -> None:
    """Under a layer the minimum of both directions' transmittances withholds some of what glossy bases reflect: at most this."""
    material = Principled(base_color=WHITE, roughness=0.4, **layers)
    for theta in (0.0, 40.0, 70.0, 85.0):
        mean, variance = energy(device, material, direction(theta, 40.0))
        assert np.all(mean < 1.0 + TOLERANCE + 5.0 * np.sqrt(variance))
        assert np.all(mean > 0.93 - 5.0 * np.sqrt(variance))


@pytest.mark.parametrize("material", [make("conductor", metal="gold", roughness=0.9, anisotropy=0.5), make("dielectric", roughness=0.9, ior=1.8),
                                      make("dielectric", roughness=0.4, ior=0.7)], ids=lambda m: m.type)
def test_compensated_lobes_are_sampled_as_their_density_says(device: cl.Device, material: Material) -> None:
    """χ² over bands of the cosine: the density integrated over each by Monte Carlo with very many uniform directions."""
    bsdf, parameters = bsdf_of(device, material), pack(material)
    generator, count, bands = np.random.default_rng(11), 1 << 17, 40
    for wo in [direction(50.0, 20.0), direction(80.0, 100.0), *([] if material.reflective else [-direction(50.0, 20.0)])]:
        s = bsdf.sample(parameters, wo, uniform(generator, count))
        observed = np.histogram(s.wi[~s.failed, 2], np.linspace(-1.0, 1.0, bands + 1))[0]
        z = (np.arange(1 << 20) + generator.random(1 << 20)) / (1 << 20) * 2.0 - 1.0
        phi = 2.0 * np.pi * np.mod(np.arange(1 << 20) * 0.6180339887498949, 1.0)
        wi = np.stack([np.sqrt(1.0 - z * z) * np.cos(phi), np.sqrt(1.0 - z * z) * np.sin(phi), z], -1)
        pdf = bsdf.evaluate(parameters, wo, wi)[1]
        expected = np.histogram(z, np.linspace(-1.0, 1.0, bands + 1), weights=pdf)[0] * 4.0 * np.pi / (1 << 20) * count
        assert chi_square(np.append(observed, count - observed.sum()), np.append(expected, max(0.0, count - expected.sum()))) > 1e-5


def test_compensation_is_reciprocal(device: cl.Device) -> None:
    generator = np.random.default_rng(3)
    for material, ior in ((make("dielectric", roughness=0.8, ior=1.5), 1.5), (make("conductor", metal="gold", roughness=0.8), 1.0)):
        bsdf, parameters = bsdf_of(device, material), pack(material)
        a, b = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in generator.normal(size=(2, 5000, 3)))
        if material.reflective:
            a[:, 2], b[:, 2] = np.abs(a[:, 2]), np.abs(b[:, 2])

        def f(wo: np.ndarray, wi: np.ndarray, bsdf=bsdf, parameters=parameters, ior=ior) -> np.ndarray:
            return bsdf.evaluate(parameters, wo, wi)[0] / np.abs(wi[:, 2:]) * np.where(wi[:, 2:] < 0.0, ior, 1.0) ** 2

        forward, backward = f(a, b), f(b, a)
        assert np.mean(np.abs(forward - backward) < 2e-3 * forward + 1e-6) > 0.998
