"""Tabulates how much light plastic's rough coat reflects: writes cl/bsdf/plastic_table.cl.

The directional reflectance of a GGX dielectric that only reflects, E(μ, roughness, η), is a three-dimensional function with steep corners.
Written as

    E = A(μ, α) F_η(c),    c = μ + α / (roughness + 0.1) κ(μ, α, η)

with A the reflectance for Fresnel reflectance 1, F_η Fresnel's equations and c an effective cosine, what remains to tabulate (A and κ) is
smooth, κ hardly depends on η, and where the coat is smooth E = F_η(μ) exactly. The cosine's axis is v = μ / (μ + α (1 − μ)).

Run it from anywhere; it takes some seconds::

    python tools/plastic_coat.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

OUTPUT = Path(__file__).resolve().parent.parent / "cl" / "bsdf" / "plastic_table.cl"

V = np.linspace(0.0, 1.0, 20)
ROUGHNESS = np.linspace(0.0, 1.0, 13)
SMALLEST_ROUGHNESS = 0.05
"""Stands for roughness 0, whose column is the limit of ever smoother coats."""
KAPPA_NODES = np.cbrt([0.001, 0.15, 3.0 / 7.0])
"""Nodes of ∛s between which κ is interpolated, s = (η − 1) / (η + 1); the last is η = 2.5."""
AVERAGE_NODES = np.array([0.0, 0.1, 0.25, 3.0 / 7.0])
"""Nodes of s between which the cosine-weighted average is interpolated."""

Array = np.ndarray


def index(s: float) -> float:
    """η from s = (η − 1) / (η + 1)."""
    return (1.0 + s) / (1.0 - s)


def fresnel(cos_i: Array, eta: float) -> Array:
    """Unpolarised Fresnel reflectance, η ≥ 1."""
    if eta == 1.0:
        return np.zeros_like(cos_i)
    n_cos_t = np.sqrt((eta - 1.0) * (eta + 1.0) + np.square(cos_i))
    s = (cos_i - n_cos_t) / (cos_i + n_cos_t)
    p = (eta * eta * cos_i - n_cos_t) / (eta * eta * cos_i + n_cos_t)
    return 0.5 * (s * s + p * p)


def reflectance(mu: float, alpha: float, etas: list[float], points: int = 192) -> Array:
    """E(μ, α, η) for each η, and A(μ, α) for an infinite one, by quadrature over the visible normals (Dupuy & Benyoub 2023)."""
    x, weights = np.polynomial.legendre.leggauss(points)
    u, phi = np.meshgrid(0.5 * (x + 1.0), 2.0 * np.pi * (np.arange(points) + 0.5) / points, indexing="ij")
    sine = np.sqrt(1.0 - mu * mu)
    w = np.array([alpha * sine, 0.0, mu])
    w /= np.linalg.norm(w)
    t = u * (1.0 + w[2])
    r = np.sqrt(t * (2.0 - t))
    m = np.stack([alpha * (r * np.cos(phi) + w[0]), alpha * r * np.sin(phi), (1.0 + w[2]) * (1.0 - u)], -1)
    m /= np.linalg.norm(m, axis=-1, keepdims=True)
    wo = np.array([sine, 0.0, mu])
    cosine = np.clip(m @ wo, 0.0, 1.0)
    wi = 2.0 * cosine[..., None] * m - wo
    a_o = np.hypot(alpha * sine, mu)
    a_i = np.sqrt(alpha**2 * (wi[..., 0] ** 2 + wi[..., 1] ** 2) + wi[..., 2] ** 2)
    g2_over_g1 = np.where(wi[..., 2] > 0.0, wi[..., 2] * (mu + a_o) / (a_o * wi[..., 2] + a_i * mu), 0.0)
    weight = g2_over_g1 * (0.5 * weights[:, None] / points)
    return np.array([np.sum(weight * (1.0 if np.isinf(eta) else fresnel(cosine, eta))) for eta in etas])


def lagrange(nodes: Array, x: float) -> Array:
    """Weights of the values at ``nodes`` for their interpolating polynomial at ``x``."""
    return np.array([np.prod([(x - b) / (a - b) for b in nodes if b != a]) for a in nodes])


def tabulate() -> Array:
    """A and κ at the nodes, shape (roughness, v, 4)."""
    cosines = np.linspace(0.0, 1.0, 100001)
    etas = [index(float(node) ** 3) for node in KAPPA_NODES]
    table = np.zeros((len(ROUGHNESS), len(V), 4))
    for j, roughness in enumerate(np.maximum(ROUGHNESS, SMALLEST_ROUGHNESS)):
        alpha = roughness**2
        for i, v in enumerate(V):
            mu = max(v * alpha / (1.0 - v + v * alpha), 1e-6)
            a, *e = reflectance(mu, alpha, [np.inf, *etas])
            effective = [np.interp(-value / a, -fresnel(cosines, eta), cosines) for value, eta in zip(e, etas, strict=True)]
            table[j, i] = [a, *((np.array(effective) - mu) * (roughness + 0.1) / alpha)]
    return table


def interpolated(table: Array, mu: Array, roughness: float, eta: float) -> Array:
    """E from the table, as plastic.cl computes it."""
    alpha = roughness**2
    x = (len(V) - 1) * mu / (mu + alpha * (1.0 - mu))
    y = (len(ROUGHNESS) - 1) * roughness
    i, j = np.minimum(x.astype(int), len(V) - 2), min(int(y), len(ROUGHNESS) - 2)
    fx, fy = (x - i)[:, None], y - j
    t = (1 - fy) * ((1 - fx) * table[j, i] + fx * table[j, i + 1]) + fy * ((1 - fx) * table[j + 1, i] + fx * table[j + 1, i + 1])
    kappa = t[:, 1:] @ lagrange(KAPPA_NODES, np.cbrt((eta - 1.0) / (eta + 1.0)))
    return t[:, 0] * fresnel(np.clip(mu + alpha / (roughness + 0.1) * kappa, 0.0, 1.0), eta)


def average_transmittance(table: Array, roughness: float, eta: float) -> float:
    """∫ (1 − E) 2μ dμ, of the interpolated E, so that the base gives back exactly what the coat lets through."""
    x, w = np.polynomial.legendre.leggauss(512)
    t = 0.5 * (x + 1.0)  # μ = t², denser at grazing angles
    mu = t * t
    return float(np.sum(0.5 * w * 2.0 * t * 2.0 * mu * (1.0 - interpolated(table, mu, roughness, eta))))


def tabulate_average(table: Array) -> Array:
    """Average transmittance, shape (roughness, nodes)."""
    return np.array([[average_transmittance(table, r, index(float(node))) for node in AVERAGE_NODES] for r in ROUGHNESS])


def source(table: Array, averages: Array) -> str:
    """The text of plastic_table.cl."""

    def rows(values: Array) -> str:
        return ",\n".join(f"    (float4)({', '.join(f'{x:.5f}f' for x in cell)})" for cell in values.reshape(-1, 4))

    def nodes(values: Array) -> str:
        return ", ".join(f"{x:.7f}f" for x in values)

    return f"""// Reflectance of plastic's coat, made by tools/plastic_coat.py, which says what it is and why: edit that, not this.
// .x: A; .yzw: κ at the nodes of ∛s, s = (η − 1) / (η + 1). A row of {len(V)} values of v for each of {len(ROUGHNESS)} roughnesses.

#define PLASTIC_TABLE_V {len(V)}
#define PLASTIC_TABLE_ROUGHNESS {len(ROUGHNESS)}
#define PLASTIC_KAPPA_NODES (float3)({nodes(KAPPA_NODES)})
#define PLASTIC_AVERAGE_NODES (float4)({nodes(AVERAGE_NODES)})

constant float4 plastic_table[PLASTIC_TABLE_ROUGHNESS * PLASTIC_TABLE_V] = {{
{rows(table)}
}};

// Cosine-weighted average of what the coat lets through, at the nodes of s, for each roughness.
constant float4 plastic_average_table[PLASTIC_TABLE_ROUGHNESS] = {{
{rows(averages)}
}};
"""


def main() -> None:
    table = tabulate()
    OUTPUT.write_text(source(table, tabulate_average(table)), encoding="utf-8")
    print(f"wrote {OUTPUT}")


if __name__ == "__main__":
    main()
