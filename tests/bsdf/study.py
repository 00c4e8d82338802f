"""What is measured of a material from one direction, once for all the tests that look at it."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import cache

import numpy as np
import pyopencl as cl

from lumiere.bsdf import MATERIALS, Material
from tests.bsdf.dispersion import channel_iors
from tests.bsdf.harness import Bsdf, Samples, bsdf_of, direction, pack, uniform
from tests.statistics import SPHERE_HIGH, SPHERE_LOW, Cells, rectangle_to_sphere, sphere_to_rectangle

Array = np.ndarray

SAMPLES = 1 << 16
PILOT_SAMPLES = 1 << 13

TEXTBOOK = "-textbook"
"""What the name of an example without energy compensation ends with."""

EXAMPLES: dict[str, Material] = {
    f"{kind}-{number}{ending}": material for kind, cls in MATERIALS.kinds().items() for number, material in enumerate(cls.examples())
    for ending in (("", TEXTBOOK) if material.compensates else ("",))
}
"""The examples of all kinds, by name; those that know energy compensation with it and without."""


def bsdf_of_example(device: cl.Device, name: str) -> Bsdf:
    """The BSDF that shades the example."""
    return bsdf_of(device, EXAMPLES[name], compensation=not name.endswith(TEXTBOOK))


def energy_tolerance(name: str) -> float:
    """How far from exact tables leave what the example scatters in all."""
    return 0.0 if name.endswith(TEXTBOOK) else EXAMPLES[name].energy_tolerance


ABOVE = {"0": direction(0.0, 0.0), "35": direction(35.0, 50.0), "65": direction(65.0, -110.0), "88": direction(88.0, 160.0)}
BELOW = {"-20": -direction(20.0, 140.0), "-70": -direction(70.0, 10.0)}
"""Viewing directions by their angle in degrees; reflective kinds have nothing to show below."""

CASES = [(name, view) for name, material in EXAMPLES.items() for view in [*ABOVE, *([] if material.reflective else BELOW)]]
VIEWS = ABOVE | BELOW


def iors(material: Material) -> Array:
    """(3,) the index of each channel, inside over outside; where glass disperses, at the medians of their wavelengths."""
    if not material.refracts:
        return np.ones(3)
    return channel_iors(material.ior, getattr(material, "abbe_number", None), 0.5)  # type: ignore[attr-defined]


def seed(*words: object) -> int:
    """A seed that depends on the words alone."""
    return zlib.crc32(repr(words).encode())


@dataclass
class Study:
    """A material seen from ``wo``: samples, and the density and f |cosθ| integrated over cells of the sphere."""

    material: Material
    bsdf: Bsdf
    parameters: Array
    wo: Array
    samples: Samples
    cells: Cells
    pdf: Array
    """(n,) ∫ pdf over each cell; ``pdf_error``: the quadrature's error."""
    pdf_error: Array
    f: Array
    """(3,) ∫ f |cosθ| over the sphere, without the Dirac lobes and without the 1 / η² of what crosses the surface."""
    f_error: Array

    @property
    def crossing(self) -> Array:
        """(3,) η², by which radiance is divided where it crosses the surface from wo's side."""
        return iors(self.material) ** (2.0 if self.wo[2] > 0.0 else -2.0)

    def lobes(self) -> list[Array]:
        """Numbers of the samples of each Dirac lobe."""
        s = self.samples
        which = np.stack([s.wi[:, 2] > 0.0, s.eta], axis=1)
        return [np.flatnonzero(s.specular & np.all(which == lobe, axis=1)) for lobe in np.unique(which[s.specular], axis=0)]

    def energy(self) -> tuple[Array, Array]:
        """(3,) fraction of the light that is scattered, by quadrature and the Dirac lobes' weights, and its error."""
        total = self.f.copy()
        s = self.samples
        for first, *_ in self.lobes():
            total += s.weight[first] * s.pdf[first] * s.eta[first] ** 2
        return total, self.f_error + 2e-6


@cache
def study(device: cl.Device, name: str, view: str) -> Study:
    """Measures the example ``name`` from ``view``."""
    material, wo = EXAMPLES[name], VIEWS[view]
    bsdf, parameters = bsdf_of_example(device, name), pack(material)
    generator = np.random.default_rng(seed(name, view))
    pilot = bsdf.sample(parameters, wo, uniform(generator, PILOT_SAMPLES))
    samples = bsdf.sample(parameters, wo, uniform(generator, SAMPLES))
    spread = sphere_to_rectangle(pilot.wi[~pilot.failed & ~pilot.specular])
    cells = Cells.around(spread, SPHERE_LOW, SPHERE_HIGH, depth=7, cuts={0: 0.0})
    result = Study(material, bsdf, parameters, wo, samples, cells, np.zeros(len(cells)), np.zeros(len(cells)), np.zeros(3), np.zeros(3))
    if material.purely_specular:
        return result

    def pdf_and_f(points: Array) -> Array:
        wi = rectangle_to_sphere(points)
        f, pdf = bsdf.evaluate(parameters, wo, wi)
        crosses = wi[:, 2] * wo[2] < 0.0
        return np.concatenate([pdf[:, None], f * np.where(crosses[:, None], result.crossing, 1.0)], axis=1)

    integrals, errors = cells.integrate(pdf_and_f, tolerance=2e-3)
    result.pdf, result.pdf_error = integrals[:, 0], errors[:, 0]
    result.f, result.f_error = integrals[:, 1:].sum(axis=0), errors[:, 1:].sum(axis=0)
    return result
