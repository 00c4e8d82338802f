"""Every kind at the ends of its parameters and at grazing angles: nothing is negative, infinite or not a number."""

from __future__ import annotations

import itertools

import numpy as np
import pyopencl as cl
import pytest

from lumiere.bsdf import Material
from lumiere.bsdf.dielectric import cauchy_dispersion
from lumiere.scene.fields import fields_of
from tests.bsdf.harness import bsdf_of_kind, uniform
from tests.bsdf.study import EXAMPLES, TEXTBOOK, seed

NUMBERS = (0.0, 1e-6, 1e-3, 0.0099, 0.01, 0.3, 1.0, 1.0001, 1.5, 2.5, 4.0, 1e3, 1e8)
SPECTRA = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (1.0, 0.0, 0.5))
COSINES = (1.0, 0.99999, 0.7, 0.1, 1e-3, 1e-5, 1e-7, 1e-20, 0.0)

DEVICE_KINDS: dict[str, list[Material]] = {}
"""The examples that each device kind shades, with energy compensation and, by another name, without."""
for _name, _material in EXAMPLES.items():
    DEVICE_KINDS.setdefault(_material.device_kind + (TEXTBOOK if _name.endswith(TEXTBOOK) else ""), []).append(_material)

DERIVED = {"dispersion": [cauchy_dispersion(abbe_number) for abbe_number in (None, 1e8, 30.0, 1.0)]}
"""Parameters that are no fields, over their range."""

MOST_RECORDS = 20_000


def extreme_parameters(material: Material, parameters: dict[str, str], generator: np.random.Generator) -> np.ndarray:
    """(n, floats) records: all combinations of the extreme values that the fields' bounds allow, or MOST_RECORDS drawn from them."""
    fields = fields_of(type(material))
    choices = []
    for name, sort in parameters.items():
        if name in DERIVED:
            choices.append([(x,) for x in DERIVED[name]])
            continue
        field = fields[name]
        low = -np.inf if field.low is None else field.low
        high = np.inf if field.high is None else field.high
        if sort == "spectrum":
            choices.append([tuple(min(x, high) for x in color) for color in SPECTRA])
        else:
            choices.append([(x,) for x in NUMBERS if (low < x if field.low_open else low <= x) and x <= high])
    if np.prod([float(len(options)) for options in choices]) <= MOST_RECORDS:
        return np.array([np.concatenate(combination) for combination in itertools.product(*choices)])
    return np.concatenate([np.array(options)[generator.integers(0, len(options), MOST_RECORDS)] for options in choices], axis=1)


def grid(generator: np.random.Generator) -> np.ndarray:
    """Unit directions on both sides at the COSINES, at a few azimuths."""
    directions = []
    for cosine, side, phi in itertools.product(COSINES, (1.0, -1.0), (0.0, np.pi, generator.uniform(0.0, 6.0))):
        r = np.sqrt((1.0 - cosine) * (1.0 + cosine))
        directions.append([r * np.cos(phi), r * np.sin(phi), side * cosine])
    return np.array(directions)


@pytest.mark.parametrize("kind", DEVICE_KINDS)
def test_extremes(device: cl.Device, kind: str) -> None:
    materials = DEVICE_KINDS[kind]
    bsdf, declared = bsdf_of_kind(device, materials, compensation=not kind.endswith(TEXTBOOK))
    reflective = all(material.reflective for material in materials)
    generator = np.random.default_rng(seed("extremes", kind))
    records, directions = extreme_parameters(materials[0], declared, generator), grid(generator)
    pairs = np.array(list(itertools.product(range(len(directions)), repeat=2)))
    count = min(400_000, len(records) * len(pairs))
    pair = pairs[generator.integers(0, len(pairs), count)]
    parameters = records[generator.integers(0, len(records), count)]
    wo, wi = directions[pair[:, 0]], directions[pair[:, 1]]

    f, pdf = bsdf.evaluate(parameters, wo, wi)
    assert np.all(np.isfinite(f)) and np.all(f >= 0.0)
    assert np.all(np.isfinite(pdf)) and np.all(pdf >= 0.0)
    if reflective:
        behind = (wo[:, 2] <= 0.0) | (wi[:, 2] <= 0.0)
        assert np.all(f[behind] == 0.0) and np.all(pdf[behind] == 0.0)

    u = uniform(generator, count)
    corner = generator.random(u.shape) < 0.2
    u[corner] = generator.choice(np.float32([0.0, 0.5, 1.0 - 2.0**-24]), np.count_nonzero(corner))
    s = bsdf.sample(parameters, wo, u)
    for values in (s.wi, s.weight, s.pdf, s.eta):
        assert np.all(np.isfinite(values))
    assert np.all(s.weight >= 0.0) and np.all(s.pdf >= 0.0) and np.all(s.eta > 0.0)
    assert np.all(np.abs(np.linalg.norm(s.wi, axis=1) - 1.0) < 2e-6)
    assert np.all(s.weight[s.failed] == 0.0)
    if reflective:
        assert np.all(s.failed[wo[:, 2] <= 0.0])

    albedo = bsdf.albedo(records)
    assert np.all((albedo >= 0.0) & (albedo <= 1.0 + 1e-6))
