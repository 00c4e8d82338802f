"""What is known of a kind from theory, in double precision and by other formulae than the device's."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pyopencl as cl
import pytest

from lumiere.bsdf import MATERIALS, SMOOTH_ROUGHNESS, Material
from lumiere.bsdf.metals import METALS
from lumiere.paths import cl_root
from tests.bsdf.harness import bsdf_of, direction, pack, uniform
from tests.bsdf.study import ABOVE, CASES, EXAMPLES, TEXTBOOK, energy_tolerance, study

REPOSITORY = Path(__file__).resolve().parents[2]


def make(kind: str, **values: object) -> Material:
    return MATERIALS.kinds()[kind](**values)


def tool(name: str) -> ModuleType:
    """The program ``tools/NAME.py`` as a module."""
    specification = importlib.util.spec_from_file_location(name, REPOSITORY / "tools" / f"{name}.py")
    assert specification is not None and specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def fresnel_reflectance(cos_i: np.ndarray, index: complex) -> np.ndarray:
    """Unpolarised reflectance of the relative, possibly complex, index: Fresnel's equations as they stand, in complex arithmetic."""
    cos_t = np.sqrt(1.0 - (1.0 - cos_i.astype(complex) ** 2) / index**2)
    s = (cos_i - index * cos_t) / (cos_i + index * cos_t)
    p = (index * cos_i - cos_t) / (index * cos_i + cos_t)
    return 0.5 * (np.abs(s) ** 2 + np.abs(p) ** 2)


def dirac_lobes(device: cl.Device, material: Material, wo: np.ndarray) -> dict[bool, tuple[float, np.ndarray, np.ndarray, float]]:
    """Crosses the surface? → probability, direction, weight and relative index of a purely specular material's lobes."""
    u = np.zeros((1024, 3), np.float32)
    u[:, 0] = (np.arange(1024) + 0.5) / 1024
    s = bsdf_of(device, material).sample(pack(material), wo, u)
    lobes = {}
    for crosses in (False, True):
        of_lobe = np.flatnonzero(~s.failed & ((s.wi[:, 2] * wo[2] < 0.0) == crosses))
        if len(of_lobe):
            first = of_lobe[0]
            lobes[crosses] = (s.pdf[first], s.wi[first], s.weight[first], s.eta[first])
    return lobes


# --- white furnaces

WHITE = {name: material for name, material in EXAMPLES.items() if not name.endswith(TEXTBOOK) and (
         (material.type in ("lambert", "oren_nayar", "plastic") and np.min(material.albedo) == 1.0)  # type: ignore[attr-defined]
         or (material.type == "mirror" and np.min(material.reflectance) == 1.0)  # type: ignore[attr-defined]
         or (material.device_kind == "conductor" and material.device_values()["eta"] == METALS["none"][0])
         or (material.device_kind in ("dielectric", "thin_dielectric") and np.min(material.transmittance) == 1.0))}  # type: ignore[attr-defined]


@pytest.mark.parametrize(("name", "view"), [(name, view) for name, view in CASES if name in WHITE])
def test_white_furnace(device: cl.Device, name: str, view: str) -> None:
    """What absorbs nothing, and loses nothing between facets, gives back exactly what it gets."""
    energy, error = study(device, name, view).energy()
    assert np.all(np.abs(energy - 1.0) <= error + max(energy_tolerance(name), 1e-5))


def test_white_furnace_covers_every_conserving_kind() -> None:
    assert {material.device_kind for material in WHITE.values()} == {
        "lambert", "oren_nayar", "plastic", "mirror", "conductor", "dielectric", "thin_dielectric"}


# --- reflectances

@pytest.mark.parametrize("metal", METALS)
def test_conductor_reflects_as_fresnel_says(device: cl.Device, metal: str) -> None:
    theta = np.linspace(0.0, 89.9, 60)
    material = make("conductor", metal=metal)
    wo = np.array([direction(t, 20.0) for t in theta])
    s = bsdf_of(device, material).sample(pack(material), wo, uniform(np.random.default_rng(1), len(wo)))
    eta, k = METALS[metal]
    for channel in range(3):
        expected = fresnel_reflectance(np.cos(np.radians(theta)), eta[channel] + 1j * k[channel])
        np.testing.assert_allclose(s.weight[:, channel], expected, atol=2e-6)
    np.testing.assert_allclose(s.wi, wo * [-1.0, -1.0, 1.0], atol=1e-7)


@pytest.mark.parametrize("ior", [0.5, 0.999, 1.0, 1.0001, 1.5, 4.0])
@pytest.mark.parametrize("theta", [0.0, 30.0, 60.0, 85.0, 89.9])
@pytest.mark.parametrize("below", [False, True], ids=["outside", "inside"])
def test_dielectric_follows_fresnel_and_snell(device: cl.Device, ior: float, theta: float, below: bool) -> None:
    wo = direction(theta, 70.0) * ([1.0, 1.0, -1.0] if below else [1.0, 1.0, 1.0])
    ior = float(np.float32(ior))
    index = 1.0 / ior if below else ior
    lobes = dirac_lobes(device, make("dielectric", ior=ior), wo)
    reflectance = fresnel_reflectance(np.array([abs(wo[2])]), index)[0]
    assert set(lobes) <= {False, True} and sum(lobe[0] for lobe in lobes.values()) == pytest.approx(1.0, abs=1e-2)
    if False in lobes:
        probability, wi, weight, eta = lobes[False]
        assert probability == pytest.approx(reflectance, abs=2e-6, rel=1e-5)
        np.testing.assert_allclose(wi, wo * [-1.0, -1.0, 1.0], atol=1e-7)
        np.testing.assert_allclose(weight, 1.0)
        assert eta == 1.0
    if True in lobes:
        probability, wi, weight, eta = lobes[True]
        assert probability == pytest.approx(1.0 - reflectance, abs=2e-6)
        np.testing.assert_allclose(wi[:2] * index, -wo[:2], atol=1e-6)  # Snell, and the plane of incidence
        assert eta == pytest.approx(index, rel=1e-6)
        np.testing.assert_allclose(weight, 1.0 / index**2, rtol=1e-5)
    else:
        assert reflectance > 0.998  # total reflection, or too little passes for 1024 strata to find


def test_index_one_is_invisible(device: cl.Device) -> None:
    for kind, roughness in (("dielectric", {"roughness": 0.0}), ("dielectric", {"roughness": 0.5}), ("thin_dielectric", {})):
        material = make(kind, ior=1.0, **roughness)
        for theta in (0.0, 60.0, 89.99):
            wo = direction(theta, -30.0)
            lobes = dirac_lobes(device, material, wo)
            assert set(lobes) == {True}
            assert lobes[True][0] == 1.0 and np.all(lobes[True][2] == 1.0)
            np.testing.assert_allclose(lobes[True][1], -wo, atol=2e-7)


@pytest.mark.parametrize("theta", [0.0, 50.0, 80.0])
def test_pane_sums_all_internal_reflections(device: cl.Device, theta: float) -> None:
    wo = direction(theta, 0.0)
    single = fresnel_reflectance(np.array([wo[2]]), 1.5)[0]
    series = single + sum((1.0 - single) ** 2 * single ** (2 * bounce + 1) for bounce in range(200))
    lobes = dirac_lobes(device, make("thin_dielectric", transmittance=(0.5, 0.5, 0.5)), wo)
    assert lobes[False][0] == pytest.approx(series, abs=2e-6)
    assert lobes[True][0] == pytest.approx(1.0 - series, abs=2e-6)
    np.testing.assert_allclose(lobes[True][2], 0.5, rtol=1e-6)
    np.testing.assert_allclose(lobes[True][1], -wo, atol=1e-7)


# --- rough kinds, by integration over the microfacets instead of over directions

def microfacet_energy(wo: np.ndarray, alpha: float, index: complex, eta: float, points: int = 256) -> tuple[float, float]:
    """(reflected, refracted) fractions of the light from ``wo`` (z > 0) off GGX facets of relative index ``index``.

    ∫ D(m) (wo·m) / cosθo · F(wo·m) G2(wo, wi(m)) dm over the facets' normals, with D and Λ in their textbook form with tan θ (Walter et al.
    2007, eq. 33; Heitz 2014, eq. 72 and 99). ``eta``: the real index for refraction; 0 where nothing is.
    """
    x, w = np.polynomial.legendre.leggauss(points)
    # D(m) cosθm is uniform in y² for tan²θ = α² (1 − y²) / y²; y is the variable, so that grazing facets make no singularity.
    y, phi = np.meshgrid(0.5 * (x + 1.0), 2.0 * np.pi * (np.arange(points) + 0.5) / points, indexing="ij")
    length = np.sqrt(y**2 + alpha**2 * (1.0 - y**2))
    weight = (0.5 * w[:, None] / points) * 2.0 * length
    sine = alpha * np.sqrt(1.0 - y**2) / length
    m = np.stack([sine * np.cos(phi), sine * np.sin(phi), y / length], -1)
    cosine = m @ wo

    def smith(cos_w: np.ndarray | float) -> np.ndarray:
        tan2 = 1.0 / np.maximum(np.square(cos_w), 1e-300) - 1.0
        return 0.5 * (np.sqrt(1.0 + alpha**2 * tan2) - 1.0)

    facing = np.clip(cosine, 0.0, None)
    reflectance = fresnel_reflectance(facing, index)
    visible = weight * facing / wo[2]
    wi_z = 2.0 * cosine * m[..., 2] - wo[2]
    g2 = 1.0 / (1.0 + smith(wo[2]) + smith(wi_z))
    reflected = np.sum(visible * reflectance * np.where(wi_z > 0.0, g2, 0.0))
    if not eta:
        return float(reflected), 0.0
    cos_t = np.sqrt(np.clip(1.0 - (1.0 - facing**2) / eta**2, 0.0, None))
    wi_z = (facing / eta - cos_t) * m[..., 2] - wo[2] / eta
    g2 = 1.0 / (1.0 + smith(wo[2]) + smith(wi_z))
    return float(reflected), float(np.sum(visible * (1.0 - reflectance) * np.where(wi_z < 0.0, g2, 0.0)))


@pytest.mark.parametrize("name", ["conductor-4-textbook", "conductor-5-textbook"])
@pytest.mark.parametrize("view", ["35", "65"])
def test_rough_conductor_loses_what_single_scattering_loses(device: cl.Device, name: str, view: str) -> None:
    values = EXAMPLES[name].device_values()
    measured = study(device, name, view)
    energy, error = measured.energy()
    for channel in range(3):
        index = values["eta"][channel] + 1j * values["k"][channel]
        expected = microfacet_energy(measured.wo, values["roughness"] ** 2, index, 0.0)[0]
        assert energy[channel] == pytest.approx(expected, abs=error[channel] + 1e-5)


@pytest.mark.parametrize("name", ["dielectric-6-textbook", "dielectric-7-textbook", "dielectric-8-textbook"])
@pytest.mark.parametrize("view", ["35", "65", "-20", "-70"])
def test_rough_dielectric_loses_what_single_scattering_loses(device: cl.Device, name: str, view: str) -> None:
    values = EXAMPLES[name].device_values()
    measured = study(device, name, view)
    eta = values["ior"] if measured.wo[2] > 0.0 else 1.0 / values["ior"]
    reflected, refracted = microfacet_energy(measured.wo * np.sign(measured.wo[2]), values["roughness"] ** 2, eta, eta)
    energy, error = measured.energy()
    # The angle of total reflection is a kink in the facets' integral, which converges slowly there.
    assert energy[0] == pytest.approx(reflected + refracted, abs=error[0] + 1.5e-4)


@pytest.mark.parametrize(("anisotropy", "ratio"), [(0.0, 1.0), (0.5, 0.55), (1.0, 0.1)])
def test_anisotropy_stretches_along_x(device: cl.Device, anisotropy: float, ratio: float) -> None:
    """Facets tilted about y by α_x and about x by α_y are equally frequent, and αy / αx is as Burley says."""
    material = make("conductor", roughness=0.2, anisotropy=anisotropy)
    alpha = 0.2**2
    alpha_x, alpha_y = alpha / np.sqrt(ratio), alpha * np.sqrt(ratio)
    wo = np.array([0.0, 0.0, 1.0])

    def tilted(slope: np.ndarray) -> np.ndarray:
        m = np.append(slope, 1.0) / np.sqrt(1.0 + slope @ slope)
        return 2.0 * m[2] * m - wo

    wi = np.array([tilted(np.array([alpha_x, 0.0])), tilted(np.array([0.0, alpha_y])), wo])
    _, pdf = bsdf_of(device, material, compensation=False).evaluate(pack(material), wo, wi)
    # D ∝ 1 / (1 + 1)² at one α from the normal, times 1 / cos⁴ for the solid angle.
    cos2 = 1.0 / (1.0 + np.array([alpha_x, alpha_y]) ** 2)
    np.testing.assert_allclose(pdf[:2] * cos2**2, pdf[2] / 4.0, rtol=1e-4)
    np.testing.assert_allclose(pdf[2], 0.25 / (np.pi * alpha_x * alpha_y), rtol=1e-4)


# --- diffuse and glossy kinds

@pytest.mark.parametrize("view", ABOVE)
def test_oren_nayar_reflects_what_the_paper_says(device: cl.Device, view: str) -> None:
    """Directional albedo of Portsmouth, Kutz & Hill 2025, listing 1: E_EON, with the exact E_FON as they write it."""
    measured = study(device, "oren_nayar-3", view)
    albedo, r = np.array(measured.material.albedo), measured.material.roughness  # type: ignore[attr-defined]
    mu = measured.wo[2]
    sine = np.sqrt(1.0 - mu * mu)
    g = sine * (np.arccos(mu) - sine * mu) + 2.0 / 3.0 * ((sine / mu) * (1.0 - sine**3) - sine)
    a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * np.pi)) * r)
    single, average = a * (1.0 + r * g / np.pi), a * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * np.pi)) * r)
    multiple = albedo**2 * average / (1.0 - albedo * (1.0 - average))
    energy, error = measured.energy()
    np.testing.assert_allclose(energy, albedo * single + multiple * (1.0 - single), atol=error.max() + 2e-6)


def test_oren_nayar_without_roughness_is_lambert(device: cl.Device) -> None:
    rough, flat = make("oren_nayar", albedo=(0.7, 0.2, 0.9), roughness=0.0), make("lambert", albedo=(0.7, 0.2, 0.9))
    wo = direction(50.0, 10.0)
    wi = np.array([direction(t, 40.0 * t) for t in np.linspace(0.0, 89.0, 30)])
    for ours, theirs in zip(bsdf_of(device, rough).evaluate(pack(rough), wo, wi), bsdf_of(device, flat).evaluate(pack(flat), wo, wi), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-5)


def test_phong_reflects_its_two_fractions_at_normal_incidence(device: cl.Device) -> None:
    measured = study(device, "phong-0", "0")
    energy, error = measured.energy()
    expected = np.add(measured.material.albedo, measured.material.specular)  # type: ignore[attr-defined]
    np.testing.assert_allclose(energy, expected, atol=error.max())


def test_phong_is_scaled_down_to_what_it_gets(device: cl.Device) -> None:
    energy, error = study(device, "phong-2", "0").energy()
    np.testing.assert_allclose(energy, 1.0, atol=error.max())


def test_plastic_without_a_coat_is_lambert(device: cl.Device) -> None:
    coated, bare = make("plastic", ior=1.0, albedo=(0.7, 0.2, 0.9)), make("lambert", albedo=(0.7, 0.2, 0.9))
    wo, wi = direction(50.0, 10.0), np.array([direction(t, 40.0 * t) for t in np.linspace(0.0, 89.0, 30)])
    np.testing.assert_allclose(bsdf_of(device, coated).evaluate(pack(coated), wo, wi)[0],
                               bsdf_of(device, bare).evaluate(pack(bare), wo, wi)[0], rtol=1e-4)


def test_smooth_plastic_couples_as_a_plate_on_a_diffuser(device: cl.Device) -> None:
    """Saunderson 1942: a diffuser of albedo a under a smooth interface, from the interface's reflectances, integrated here."""
    material = make("plastic", albedo=(0.8, 0.5, 0.1), ior=1.5, roughness=0.0)
    x, w = np.polynomial.legendre.leggauss(200)
    critical = np.sqrt(1.0 - 1.0 / 1.5**2)
    mu = critical + (1.0 - critical) * (0.5 * (x + 1.0)) ** 2
    inside = critical**2 + np.sum(w * (1.0 - critical) * (x + 1.0) * mu * fresnel_reflectance(mu, 1.0 / 1.5))
    wo, wi = direction(40.0, 0.0), np.array([direction(t, 100.0) for t in (0.0, 30.0, 75.0)])
    albedo = np.array(material.albedo)  # type: ignore[attr-defined]
    passes = (1.0 - fresnel_reflectance(wo[2:], 1.5)) * (1.0 - fresnel_reflectance(wi[:, 2], 1.5)) / 1.5**2
    expected = passes[:, None] * wi[:, 2:] / np.pi * albedo / (1.0 - albedo * inside)
    np.testing.assert_allclose(bsdf_of(device, material).evaluate(pack(material), wo, wi)[0], expected, rtol=0.01)


def test_textbook_plastic_loses_what_single_scattering_loses(device: cl.Device) -> None:
    """What crosses the rough coat, from microfacets' integrals over Walter's refraction; inside, a geometric series of what comes back."""
    ior, roughness, albedo = 1.5, 0.7, 0.6
    x, w = np.polynomial.legendre.leggauss(12)
    mu = 0.5 * (x + 1.0)

    def energies(eta: float) -> np.ndarray:
        views = [np.array([np.sqrt(1.0 - c * c), 0.0, c]) for c in mu]
        return np.array([microfacet_energy(v, roughness**2, eta, eta) for v in views])

    inside = np.sum(w * mu * energies(1.0 / ior)[:, 0])
    wo, wi = direction(40.0, 0.0), direction(65.0, 100.0)
    passes = microfacet_energy(wo, roughness**2, ior, ior)[1] * microfacet_energy(wi, roughness**2, ior, ior)[1] / ior**2
    expected = passes * wi[2] / np.pi * albedo / (1.0 - albedo * inside)
    coated, bare = (make("plastic", albedo=(a,) * 3, ior=ior, roughness=roughness) for a in (albedo, 0.0))
    bsdf = bsdf_of(device, coated, compensation=False)
    found = bsdf.evaluate(pack(coated), wo, wi)[0] - bsdf.evaluate(pack(bare), wo, wi)[0]
    np.testing.assert_allclose(found[0], expected, rtol=0.01)
    assert np.all(bsdf_of(device, coated).evaluate(pack(coated), wo, wi)[0][0] > bsdf.evaluate(pack(coated), wo, wi)[0][0] * 1.02)


# --- the host's side

def test_smoothness_threshold_is_the_same_on_both_sides() -> None:
    found = re.search(r"#define SMOOTH_ROUGHNESS ([0-9.]+)f", (cl_root() / "lib" / "microfacet.cl").read_text(encoding="utf-8"))
    assert found is not None and float(found.group(1)) == SMOOTH_ROUGHNESS


@pytest.mark.parametrize("kind", ["conductor", "dielectric"])
def test_roughness_picks_the_device_kind(kind: str) -> None:
    assert make(kind, roughness=0.009).device_kind == kind and make(kind, roughness=0.009).purely_specular
    assert make(kind, roughness=0.01).device_kind == f"rough_{kind}" and not make(kind, roughness=0.01).purely_specular
    textured = make(kind, roughness=object())
    assert textured.device_kind == f"rough_{kind}" and "roughness" in textured.device_parameters


def test_conductor_complains() -> None:
    assert make("conductor").check() is None and make("conductor", metal="gold").check() is None
    assert make("conductor", eta=(1.0,) * 3, k=(2.0,) * 3).check() is None
    for values in ({"metal": "gold", "eta": (1.0,) * 3, "k": (2.0,) * 3}, {"metal": "gold", "k": (2.0,) * 3}, {"eta": (1.0,) * 3}, {"k": (1.0,) * 3}):
        complaint = make("conductor", **values).check()
        assert complaint is not None and "\n" not in complaint


def test_metals_are_what_their_spectra_reduce_to() -> None:
    metals = tool("metals")
    assert set(metals.SPECTRA) | {"none"} == set(METALS)
    for name, (_, rows) in metals.SPECTRA.items():
        np.testing.assert_allclose(METALS[name], metals.reduce(rows), atol=6e-5)
    np.testing.assert_allclose(metals.channel_weights(np.arange(380.0, 781.0)).sum(axis=1), 1.0)


def test_plastic_table_is_what_its_tool_makes() -> None:
    plastic = tool("plastic_coat")
    text = (cl_root() / "bsdf" / "plastic_table.cl").read_text(encoding="utf-8")
    text = text[text.index("plastic_table["):text.index("plastic_average_table[")]
    cells = [[float(x.strip(" f")) for x in cell.split(",")] for cell in re.findall(r"\(float4\)\(([^)]+)\)", text)]
    table = np.array(cells).reshape(len(plastic.ROUGHNESS), len(plastic.V), 4)
    for j, i in ((2, 3), (5, 9), (8, 12)):
        roughness, v = plastic.ROUGHNESS[j], plastic.V[i]
        mu = v * roughness**2 / (1.0 - v + v * roughness**2)
        assert table[j, i, 0] == pytest.approx(plastic.reflectance(mu, roughness**2, [np.inf])[0], abs=2e-5)
        for node in plastic.KAPPA_NODES:
            eta = plastic.index(float(node) ** 3)
            exact = plastic.reflectance(mu, roughness**2, [eta])[0]
            assert plastic.interpolated(table, np.array([mu]), roughness, eta)[0] == pytest.approx(exact, abs=2e-5)
