"""Every kind's examples: is what is sampled what the density says, and is the weight their quotient?

These tests know the registry alone: a new kind is tested by existing.
"""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from tests.bsdf.harness import pack, uniform
from tests.bsdf.study import CASES, EXAMPLES, SAMPLES, Study, bsdf_of_example, energy_tolerance, iors, seed, study
from tests.statistics import chi_square, mean_and_variance, sidak, sphere_to_rectangle, z_test

SIGNIFICANCE = sidak(1e-3, len(CASES))
"""Level of each χ² test, so that all of them together fail by chance once in a thousand choices of the seed."""

ROUGH_CASES = [case for case in CASES if not EXAMPLES[case[0]].purely_specular]

each_case = pytest.mark.parametrize(("name", "view"), CASES, ids=["_".join(case) for case in CASES])
each_rough_case = pytest.mark.parametrize(("name", "view"), ROUGH_CASES, ids=["_".join(case) for case in ROUGH_CASES])


def counts(measured: Study) -> tuple[np.ndarray, np.ndarray]:
    """Observed and expected numbers of samples: in each cell, in each Dirac lobe, and failed."""
    s = measured.samples
    observed = list(measured.cells.count(sphere_to_rectangle(s.wi[~s.failed & ~s.specular])))
    expected = list(SAMPLES * measured.pdf)
    for lobe in measured.lobes():
        observed.append(len(lobe))
        expected.append(SAMPLES * s.pdf[lobe[0]])
    observed.append(np.count_nonzero(s.failed))
    expected.append(max(0.0, SAMPLES - sum(expected)))
    return np.array(observed, float), np.array(expected, float)


@each_case
def test_samples_follow_the_density(device: cl.Device, name: str, view: str) -> None:
    measured = study(device, name, view)
    assert chi_square(*counts(measured)) > SIGNIFICANCE


@each_case
def test_density_is_normalised(device: cl.Device, name: str, view: str) -> None:
    """The density and the Dirac lobes' probabilities make 1, less the failures' probability."""
    measured = study(device, name, view)
    s = measured.samples
    total = measured.pdf.sum() + sum(s.pdf[lobe[0]] for lobe in measured.lobes())
    error = measured.pdf_error.sum() + 1e-6
    assert total <= 1.0 + error
    failures = np.mean(s.failed)
    assert abs(1.0 - total - failures) <= 5.0 * np.sqrt(max(1.0 - total, failures) / SAMPLES) + error


@each_rough_case
def test_sample_agrees_with_eval_and_pdf(device: cl.Device, name: str, view: str) -> None:
    """pdf = pdf(wi) and weight = f |cosθ| / pdf, as far as the direction's rounding allows: its effect is measured by moving it."""
    measured = study(device, name, view)
    s = measured.samples
    ok = np.flatnonzero(~s.failed & ~s.specular)[:8192]
    if len(ok) == 0:  # all of it is Dirac lobes, or nothing at all: so must f and the density say
        assert not measured.pdf.any() and not measured.f.any()
        return
    wi, weight, pdf_sampled = s.wi[ok], s.weight[ok], s.pdf[ok]
    f, pdf = measured.bsdf.evaluate(measured.parameters, measured.wo, wi)
    generator = np.random.default_rng(seed("moved", name, view))
    f_change, pdf_change = np.zeros_like(f), np.zeros_like(pdf)
    for _ in range(4):
        moved = wi + generator.uniform(-2.0**-22, 2.0**-22, wi.shape)
        f_moved, pdf_moved = measured.bsdf.evaluate(measured.parameters, measured.wo, moved)
        f_change, pdf_change = np.maximum(f_change, np.abs(f_moved - f)), np.maximum(pdf_change, np.abs(pdf_moved - pdf))
    within_pdf = np.abs(pdf_sampled - pdf) <= 4.0 * pdf_change + 1e-5 * pdf
    within_f = np.abs(weight * pdf_sampled[:, None] - f) <= 4.0 * (f_change + weight * pdf_change[:, None]) + 1e-5 * f
    # The measured effect is itself a sample: a few in a thousand may exceed it, but not by much.
    assert np.mean(within_pdf) > 0.998 and np.mean(within_f) > 0.998
    usual = np.median(pdf_change / np.maximum(pdf, 1e-30))
    assert np.quantile(np.abs(pdf_sampled / np.maximum(pdf, 1e-30) - 1.0), 0.99) <= 20.0 * usual + 1e-4


@each_case
def test_weights_estimate_the_energy(device: cl.Device, name: str, view: str) -> None:
    """The mean weight is ∫ f |cosθ|, so nothing of f is out of the sampling's reach, and nothing is counted twice."""
    measured = study(device, name, view)
    energy, error = measured.energy()
    s = measured.samples
    crosses = s.wi[:, 2] * measured.wo[2] < 0.0
    mean, variance = mean_and_variance(s.weight * np.where(crosses[:, None], measured.crossing, 1.0))
    beyond = np.maximum(np.abs(mean - energy) - error, 0.0)
    assert np.all(z_test(beyond, variance + 1e-12) > SIGNIFICANCE / 3.0)


@each_case
def test_no_energy_is_made(device: cl.Device, name: str, view: str) -> None:
    measured = study(device, name, view)
    energy, error = measured.energy()
    # What is tabulated states how good its table is; everything else is exact.
    assert np.all(energy <= 1.0 + error + max(energy_tolerance(name), 1e-5))


@each_case
def test_samples_are_well_formed(device: cl.Device, name: str, view: str) -> None:
    measured = study(device, name, view)
    s = measured.samples
    for values in (s.wi, s.weight, s.pdf, s.eta):
        assert np.all(np.isfinite(values))
    assert np.all(s.weight >= 0.0) and np.all(s.pdf >= 0.0) and np.all(s.eta > 0.0)
    assert np.all(s.weight[s.failed] == 0.0)
    assert np.all(np.abs(np.linalg.norm(s.wi, axis=1) - 1.0) < 1e-6)
    crosses = (s.wi[:, 2] * measured.wo[2] < 0.0) & ~s.failed
    if measured.material.reflective:
        assert not crosses.any()
    assert np.all(s.eta[~crosses] == 1.0)
    assert np.all(np.any(np.abs(s.eta[crosses, None] ** 2 / measured.crossing - 1.0) < 1e-5, axis=1))
    if measured.material.purely_specular:
        assert np.all(s.specular | s.failed)


@pytest.mark.parametrize("name", [name for name, material in EXAMPLES.items() if not material.purely_specular])
def test_reciprocity(device: cl.Device, name: str) -> None:
    """f(wo, wi) n(wi)² = f(wi, wo) n(wo)², n the index on the direction's side (Veach 1997, eq. 5.14); the pairs are what is sampled."""
    material = EXAMPLES[name]
    bsdf, parameters = bsdf_of_example(device, name), pack(material)
    generator = np.random.default_rng(seed("reciprocity", name))
    wo = generator.normal(size=(20000, 3))
    wo /= np.linalg.norm(wo, axis=1, keepdims=True)
    if not material.refracts:
        wo[:, 2] = np.abs(wo[:, 2])
    s = bsdf.sample(parameters, wo, uniform(generator, len(wo)))
    ok = ~s.failed & ~s.specular & (np.abs(s.wi[:, 2]) > 1e-3) & (np.abs(wo[:, 2]) > 1e-3)
    wo, wi = wo[ok], s.wi[ok]

    def f(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return bsdf.evaluate(parameters, a, b)[0] / np.abs(b[:, 2:]) * np.where(b[:, 2:] < 0.0, iors(material), 1.0) ** 2

    forward, backward = f(wo, wi), f(wi, wo)
    change = np.zeros_like(forward)
    for _ in range(4):
        move = generator.uniform(-2.0**-22, 2.0**-22, wi.shape)
        change = np.maximum(change, np.abs(f(wo, wi + move) - forward))
    assert len(wo) > 2000
    assert np.mean(np.abs(forward - backward) <= 4.0 * change + 1e-4 * forward) > 0.998
