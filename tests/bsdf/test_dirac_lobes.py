"""Dirac lobes of kinds that reflect: where they go, and that rough kinds have them where their roughness vanishes."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from lumiere.bsdf import MATERIALS, Material
from tests.bsdf.harness import Samples, bsdf_of, pack, uniform

COUNT = 4096


def make(kind: str, **values: object) -> Material:
    return MATERIALS.kinds()[kind](**values)


def directions(generator: np.random.Generator, *, both_sides: bool = False) -> np.ndarray:
    wo = generator.normal(size=(COUNT, 3))
    wo /= np.linalg.norm(wo, axis=1, keepdims=True)
    return wo if both_sides else np.abs(wo) * [1.0, -1.0, 1.0]


@pytest.mark.parametrize("material", [make("mirror", reflectance=(0.9, 0.5, 0.1)), make("conductor"), make("plastic", roughness=0.0)],
                         ids=lambda material: material.type)
def test_reflection_is_about_the_normal(device: cl.Device, material: Material) -> None:
    generator = np.random.default_rng(3)
    wo = directions(generator)
    s = bsdf_of(device, material).sample(pack(material), wo, uniform(generator, COUNT))
    assert np.count_nonzero(s.specular) > 100
    np.testing.assert_allclose(s.wi[s.specular], (wo * [-1.0, -1.0, 1.0])[s.specular], atol=1e-7)
    if material.type == "mirror":
        np.testing.assert_allclose(s.weight, np.broadcast_to([0.9, 0.5, 0.1], s.weight.shape), rtol=1e-6)


def assert_same(a: Samples, b: Samples) -> None:
    for ours, theirs in ((a.wi, b.wi), (a.weight, b.weight), (a.pdf, b.pdf), (a.eta, b.eta), (a.specular, b.specular)):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("kind", ["conductor", "dielectric"])
@pytest.mark.parametrize("roughness", [0.0, 1e-6, 0.0099])
def test_rough_kind_is_the_smooth_one_where_its_roughness_vanishes(device: cl.Device, kind: str, roughness: float) -> None:
    """A texture may say 0 anywhere: then the rough kind's lobes are the smooth kind's, to the bit."""
    smooth, rough = make(kind), make(kind, roughness=0.5)
    record = pack(rough)
    record[np.flatnonzero(record == 0.5)[0]] = roughness
    generator = np.random.default_rng(4)
    wo, u = directions(generator, both_sides=True), uniform(generator, COUNT)
    ours = bsdf_of(device, rough).sample(record, wo, u)
    assert np.count_nonzero(ours.specular) > 100
    assert_same(ours, bsdf_of(device, smooth).sample(pack(smooth), wo, u))
    f, pdf = bsdf_of(device, rough).evaluate(record, wo, ours.wi)
    assert not f.any() and not pdf.any()


def test_alike_indices_make_rough_glass_smooth(device: cl.Device) -> None:
    """Where α |η − 1| < 10⁻⁴ the facets cannot be told from the directions: rough glass is then shaded as smooth glass of the same index."""
    rough, smooth = make("dielectric", ior=1.00005, roughness=1.0), make("dielectric", ior=1.00005)
    generator = np.random.default_rng(5)
    wo, u = directions(generator, both_sides=True), uniform(generator, COUNT)
    assert_same(bsdf_of(device, rough).sample(pack(rough), wo, u), bsdf_of(device, smooth).sample(pack(smooth), wo, u))
