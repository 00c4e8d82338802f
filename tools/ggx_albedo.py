"""Tabulates how much light rough surfaces scatter: writes cl/lib/{ggx,interface,sheen}_albedo_table.cl.

What a BSDF reflects of the light from one direction is what a layer below it does not get, and what compensation must give back. Three are needed:

* GGX microfacets that only reflect, with Schlick's Fresnel reflectance F = f0 + (f90 − f0) (1 − cosθ)⁵. The reflectance is linear in f0 and f90,
  so that two functions of (μ, roughness) say all of it: E = A (f0 + (f90 − f0) (1 − c)⁵), A the reflectance for F = 1, and an effective cosine
  c = μ + α / (roughness + 0.1) κ: A and κ are smooth, and where the surface is smooth E = F(μ) exactly.
* GGX interfaces between dielectrics: the fraction L that is lost, neither reflected nor refracted after one scattering, over (μ, roughness, η). Its
  table's values are those whose interpolation is nearest to L everywhere, in least squares: L at the nodes would be thrice as far off between them.
* Charlie sheen (Estevez & Kulla 2017).

The cosine's axis is s = √μ / (√μ + roughness √(1 − μ)), which spreads grazing angles as the roughness does. η's axis is
y = (1 − min(η, 1/η))^(3/8), finer about 1, where L is steep; there are more nodes for η < 1, where reflection becomes total.

Run it from anywhere; it takes five minutes::

    python tools/ggx_albedo.py
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import lsqr
from scipy.stats import qmc

OUTPUT = Path(__file__).resolve().parent.parent / "cl" / "lib"

Array = np.ndarray

SMALLEST_ROUGHNESS = 0.03
"""Stands for roughness 0, whose column is the limit of ever smoother surfaces."""
GGX_COSINES, GGX_ROUGHNESSES = 24, 17
INTERFACE_COSINES, INTERFACE_ROUGHNESSES = 20, 15
INTERFACE_INDICES_BELOW, INTERFACE_INDICES_ABOVE = 33, 17
"""Nodes of y for η < 1 and for η > 1."""
INTERFACE_SAMPLES = 17
"""log₂ of the points at which L is fitted, on each side."""
SHEEN_COSINES, SHEEN_ROUGHNESSES = 16, 16
SMALLEST_SHEEN_ROUGHNESS = 0.1


def cosine(s: float, roughness: float) -> float:
    """μ of a node of the cosine's axis."""
    t = (roughness * s / max(1.0 - s, 1e-9)) ** 2
    return float(np.clip(t / (1.0 + t), 1e-6, 1.0))


def axis(mu: Array, roughness: float) -> Array:
    """The inverse of ``cosine``."""
    return np.sqrt(mu) / (np.sqrt(mu) + roughness * np.sqrt(1.0 - mu))


def visible_normals(mu: float, alpha: float, points: int) -> tuple[Array, Array, Array]:
    """wo, normals visible from it (points², 3), and the share of each: a quadrature (Dupuy & Benyoub 2023)."""
    x, weights = np.polynomial.legendre.leggauss(points)
    u, phi = np.meshgrid(0.5 * (x + 1.0), 2.0 * np.pi * (np.arange(points) + 0.5) / points, indexing="ij")
    share = np.repeat(0.5 * weights[:, None], points, axis=1) / points
    sine = np.sqrt(1.0 - mu * mu)
    w = np.array([alpha * sine, 0.0, mu])
    w /= np.linalg.norm(w)
    t = u * (1.0 + w[2])
    r = np.sqrt(t * (2.0 - t))
    m = np.stack([alpha * (r * np.cos(phi) + w[0]), alpha * r * np.sin(phi), (1.0 + w[2]) * (1.0 - u)], -1)
    m /= np.linalg.norm(m, axis=-1, keepdims=True)
    return np.array([sine, 0.0, mu]), m.reshape(-1, 3), share.ravel()


def g2_over_g1(wo: Array, wi: Array, alpha: float, above: bool) -> Array:
    """What is left of a sample's weight; 0 where wi is on the wrong side."""

    def a(w: Array) -> Array:
        return np.sqrt(alpha**2 * (w[..., 0] ** 2 + w[..., 1] ** 2) + w[..., 2] ** 2)

    cos_i, cos_o, a_o = np.abs(wi[..., 2]), wo[2], a(wo)
    weight = cos_i * (cos_o + a_o) / np.maximum(a_o * cos_i + a(wi) * cos_o, 1e-300)
    return np.where((wi[..., 2] > 0.0) == above, weight, 0.0)


def reflectance(mu: float, alpha: float, points: int = 192) -> tuple[float, float]:
    """E for F = 1 and for F = (1 − cosθ)⁵."""
    wo, m, share = visible_normals(mu, alpha, points)
    c = np.clip(m @ wo, 0.0, 1.0)
    weight = share * g2_over_g1(wo, 2.0 * c[:, None] * m - wo, alpha, True)
    return float(weight.sum()), float((weight * (1.0 - c) ** 5).sum())


def loss(mu: float, alpha: float, eta: float, points: int = 128) -> float:
    """What an interface of relative index ``eta`` loses of the light from the side where it is 1."""
    wo, m, share = visible_normals(mu, alpha, points)
    c = np.clip(m @ wo, 0.0, 1.0)
    n_cos_t = np.sqrt(np.maximum((eta - 1.0) * (eta + 1.0) + c * c, 0.0))
    s, p = (c - n_cos_t) / (c + n_cos_t), (eta * eta * c - n_cos_t) / (eta * eta * c + n_cos_t)
    fresnel = 0.5 * (s * s + p * p)
    reflected, refracted = 2.0 * c[:, None] * m - wo, (c - n_cos_t)[:, None] / eta * m - wo / eta
    kept = fresnel * g2_over_g1(wo, reflected, alpha, True) + (1.0 - fresnel) * g2_over_g1(wo, refracted, alpha, False)
    return max(0.0, 1.0 - float((share * kept).sum()))


def sheen(mu: float, roughness: float, points: int = 256) -> float:
    """Reflectance of Charlie with the shadowing of Neubelt & Pettineo 2013: cl/lib/sheen.cl."""
    x, weights = np.polynomial.legendre.leggauss(points)
    cos_i, phi = np.meshgrid(0.5 * (x + 1.0), np.pi * (np.arange(points) + 0.5) / points, indexing="ij")
    sin_i = np.sqrt(1.0 - cos_i**2)
    wo = np.array([np.sqrt(1.0 - mu * mu), 0.0, mu])
    h = np.stack([sin_i * np.cos(phi), sin_i * np.sin(phi), cos_i], -1) + wo
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    inverse = 1.0 / roughness**2
    density = (2.0 + inverse) * np.power(np.maximum(1.0 - h[..., 2] ** 2, 0.0), 0.5 * inverse) / (2.0 * np.pi)
    f = density / (4.0 * (mu + cos_i - mu * cos_i)) * cos_i
    return float((f * 0.5 * weights[:, None]).sum() * 2.0 * np.pi / points)


def bilinear(table: Array, s: Array, y: float) -> Array:
    """``table`` (rows over y, columns over s) at s and y, both in [0, 1]."""
    x, y = (table.shape[1] - 1) * s, (table.shape[0] - 1) * y
    i, j = np.minimum(x.astype(int), table.shape[1] - 2), min(int(y), table.shape[0] - 2)
    fx, fy = x - i, y - j
    fx = fx.reshape(fx.shape + (1,) * (table.ndim - 2))
    return (1 - fy) * ((1 - fx) * table[j, i] + fx * table[j, i + 1]) + fy * ((1 - fx) * table[j + 1, i] + fx * table[j + 1, i + 1])


def average(function, points: int = 512) -> Array:
    """∫ function(μ) 2μ dμ."""
    x, w = np.polynomial.legendre.leggauss(points)
    t = 0.5 * (x + 1.0)  # μ = t², denser at grazing angles
    mu = t * t
    return np.tensordot(0.5 * w * 4.0 * t * mu, function(mu), axes=(0, 0))


def ggx_tables() -> tuple[Array, Array]:
    """(roughness, s, 2) A and κ; (roughness, 2) averages of A and of A (1 − c)⁵."""
    roughnesses = np.linspace(0.0, 1.0, GGX_ROUGHNESSES)
    table = np.zeros((GGX_ROUGHNESSES, GGX_COSINES, 2))
    for j, r in enumerate(np.maximum(roughnesses, SMALLEST_ROUGHNESS)):
        for i, s in enumerate(np.linspace(0.0, 1.0, GGX_COSINES)):
            mu = cosine(s, r)
            a, edge = reflectance(mu, r * r)
            table[j, i] = a, (1.0 - (edge / a) ** 0.2 - mu) * (r + 0.1) / (r * r)

    def both(mu: Array, r: float) -> Array:
        a, kappa = bilinear(table, axis(mu, r), r).T
        c = np.clip(mu + r * r / (r + 0.1) * kappa, 0.0, 1.0)
        return np.stack([a, a * (1.0 - c) ** 5], -1)

    return table, np.array([average(lambda mu, r=r: both(mu, r)) for r in roughnesses])


def interface_index(y: float) -> float:
    """η < 1 of a node of the index's axis."""
    return 1.0 - float(np.clip(y ** (8.0 / 3.0), 1e-6, 0.998))


def fitted(function: Callable[[float, float, float], float], shape: tuple[int, int, int]) -> Array:
    """Values at a grid over [0, 1]³ whose trilinear interpolation is nearest to ``function``, in least squares at the points of a Sobol sequence."""
    points = qmc.Sobol(len(shape), seed=0).random_base2(INTERFACE_SAMPLES)
    scaled = points * (np.array(shape) - 1)
    first = np.minimum(scaled.astype(int), np.array(shape) - 2)
    rest = scaled - first
    weights, columns = [], []
    for corner in itertools.product((0, 1), repeat=len(shape)):
        weights.append(np.prod(np.where(corner, rest, 1.0 - rest), axis=1))
        columns.append(np.ravel_multi_index(tuple((first + corner).T), shape))
    rows = np.tile(np.arange(len(points)), len(weights))
    matrix = coo_matrix((np.concatenate(weights), (rows, np.concatenate(columns))), shape=(len(points), int(np.prod(shape)))).tocsr()
    # The damping decides at nodes that no point is near to.
    return np.clip(lsqr(matrix, [function(*p) for p in points], damp=1e-3, iter_lim=300)[0], 0.0, 1.0).reshape(shape)


def interface_side(indices: int, *, below: bool) -> Array:
    """(y, roughness, s) L of one side."""

    def lost(y: float, roughness: float, s: float) -> float:
        r, eta = max(roughness, SMALLEST_ROUGHNESS), interface_index(y)
        return loss(cosine(s, r), r * r, eta if below else 1.0 / eta, points=40)

    return fitted(lost, (indices, INTERFACE_ROUGHNESSES, INTERFACE_COSINES))


def interface_tables() -> tuple[Array, Array]:
    """(y, roughness, s) L, of η < 1 and behind it of η > 1; and (y, roughness) its averages."""
    table = np.concatenate([interface_side(INTERFACE_INDICES_BELOW, below=True), interface_side(INTERFACE_INDICES_ABOVE, below=False)])
    roughnesses = np.linspace(0.0, 1.0, INTERFACE_ROUGHNESSES)
    averages = np.array([[average(lambda mu, r=r, t=t: bilinear(t, axis(mu, r), r)) for r in roughnesses] for t in table])
    return table, averages


def sheen_tables() -> tuple[Array, Array]:
    """(roughness, √μ) E, and its averages."""
    roughnesses = np.linspace(SMALLEST_SHEEN_ROUGHNESS, 1.0, SHEEN_ROUGHNESSES)
    table = np.array([[sheen(max(float(s * s), 1e-5), r) for s in np.linspace(0.0, 1.0, SHEEN_COSINES)] for r in roughnesses])
    y = (roughnesses - SMALLEST_SHEEN_ROUGHNESS) / (1.0 - SMALLEST_SHEEN_ROUGHNESS)
    return table, np.array([average(lambda mu, v=v: bilinear(table, np.sqrt(mu), v)) for v in y])


def rows(values: Array) -> str:
    """Initialisers: of float2 where the last axis is 2, else of floats; of integers as they are."""
    if values.shape[-1] == 2:
        cells = [f"(float2)({a:.5f}f, {b:.5f}f)" for a, b in values.reshape(-1, 2)]
        width = 4
    elif values.dtype == np.uint16:
        cells, width = [str(x) for x in values.ravel()], 20
    else:
        cells, width = [f"{x:.5f}f" for x in values.ravel()], 13
    return ",\n".join("    " + ", ".join(cells[i:i + width]) for i in range(0, len(cells), width))


def whole(values: Array) -> Array:
    """In 65535ths."""
    return np.round(65535.0 * values).astype(np.uint16)


def write(name: str, title: str, defines: dict[str, object], arrays: list[tuple[str, str, Array]]) -> None:
    """One table file."""
    text = f"// {title} Made by tools/ggx_albedo.py, which says what it is: edit that, not this.\n\n"
    text += "".join(f"#define {key} {value}\n" for key, value in defines.items())
    for declaration, comment, values in arrays:
        text += f"\n// {comment}\nconstant {declaration} = {{\n{rows(values)}\n}};\n"
    (OUTPUT / name).write_text(text, encoding="utf-8")


def main() -> None:
    """Writes the three files."""
    table, averages = ggx_tables()
    write("ggx_albedo_table.cl", "Reflectance of GGX microfacets.", {"GGX_ALBEDO_COSINES": GGX_COSINES, "GGX_ALBEDO_ROUGHNESSES": GGX_ROUGHNESSES}, [
        ("float2 ggx_albedo_table[GGX_ALBEDO_ROUGHNESSES * GGX_ALBEDO_COSINES]", ".x: A; .y: κ. A row of s for each roughness.", table),
        ("float2 ggx_albedo_average_table[GGX_ALBEDO_ROUGHNESSES]", "Cosine-weighted averages: .x of A, .y of A (1 − c)⁵.", averages)])
    table, averages = interface_tables()
    defines = {"INTERFACE_LOSS_COSINES": INTERFACE_COSINES, "INTERFACE_LOSS_ROUGHNESSES": INTERFACE_ROUGHNESSES,
               "INTERFACE_LOSS_BELOW": INTERFACE_INDICES_BELOW, "INTERFACE_LOSS_ABOVE": INTERFACE_INDICES_ABOVE}
    count = "(INTERFACE_LOSS_BELOW + INTERFACE_LOSS_ABOVE) * INTERFACE_LOSS_ROUGHNESSES"
    write("interface_albedo_table.cl", "What rough dielectric interfaces lose, in 65535ths.", defines, [
        (f"ushort interface_loss_table[{count} * INTERFACE_LOSS_COSINES]",
         "L: rows of s for each roughness, for each y, of η < 1 and then of η > 1.", whole(table)),
        (f"ushort interface_loss_average_table[{count}]", "Cosine-weighted averages of L: a row of roughnesses for each y.", whole(averages))])
    table, averages = sheen_tables()
    defines = {"SHEEN_COSINES": SHEEN_COSINES, "SHEEN_ROUGHNESSES": SHEEN_ROUGHNESSES, "SMALLEST_SHEEN_ROUGHNESS": f"{SMALLEST_SHEEN_ROUGHNESS}f"}
    write("sheen_albedo_table.cl", "Reflectance of sheen.", defines, [
        ("float sheen_table[SHEEN_ROUGHNESSES * SHEEN_COSINES]", "A row of √μ for each roughness from SMALLEST_SHEEN_ROUGHNESS to 1.", table),
        ("float sheen_average_table[SHEEN_ROUGHNESSES]", "Cosine-weighted averages.", averages)])


if __name__ == "__main__":
    main()
