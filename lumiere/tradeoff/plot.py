"""Error against time, as SVG."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from lumiere.tradeoff.measure import Measurement
from lumiere.tradeoff.settings import OWN

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 920, 480, 70, 240, 20, 50

COLORS = ("#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5c00", "#8031a7", "#b00020")
"""Of the factors, in the order in which they appear; the first eight after Okabe & Ito 2008, to be told apart by the colour-blind too."""


def pareto(measurements: Sequence[Measurement]) -> list[Measurement]:
    """Those that no other beats in both time and error, by time."""
    front: list[Measurement] = []
    for m in sorted(measurements, key=lambda m: (m.seconds, m.error)):
        if not front or m.error < front[-1].error:
            front.append(m)
    return front


def colors(measurements: Sequence[Measurement]) -> dict[str, str]:
    """Factor → colour."""
    factors = list(dict.fromkeys(m.setting.factor for m in measurements))
    factors.sort(key=lambda f: f != OWN)
    return {factor: COLORS[i % len(COLORS)] for i, factor in enumerate(factors)}


def _ticks(low: float, high: float) -> list[float]:
    """1, 2 and 5 times powers of ten; powers alone where the axis is long."""
    steps = (1, 2, 5) if high / low < 300 else (1,)
    return [s * 10.0**e for e in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1) for s in steps if low <= s * 10.0**e <= high]


def plot(measurements: Sequence[Measurement]) -> str:
    """The SVG: a point a measurement, lines through a setting's spp, and the Pareto front."""
    shown = [m for m in measurements if m.seconds > 0.0 and m.error > 0.0]
    times, errors = [m.seconds for m in shown], [m.error for m in shown]
    low_t, high_t, low_e, high_e = min(times) / 1.3, max(times) * 1.3, min(errors) / 1.5, max(errors) * 1.5

    def x(seconds: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * math.log(seconds / low_t) / math.log(high_t / low_t)

    def y(error: float) -> float:
        return TOP + (HEIGHT - TOP - BOTTOM) * math.log(high_e / error) / math.log(high_e / low_e)

    def path(members: Sequence[Measurement]) -> str:
        return " ".join(f"{x(m.seconds):.1f},{y(m.error):.1f}" for m in members)

    parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="relative error against time">']
    for t in _ticks(low_t, high_t):
        parts.append(f'<line class="grid" x1="{x(t):.1f}" x2="{x(t):.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>'
                     f'<text x="{x(t):.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{t:g}</text>')
    for e in _ticks(low_e, high_e):
        parts.append(f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(e):.1f}" y2="{y(e):.1f}"/>'
                     f'<text x="{LEFT - 8}" y="{y(e) + 4:.1f}" text-anchor="end">{e:.0e}</text>')
    parts.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 8}" text-anchor="middle">seconds a picture</text>'
                 f'<text transform="translate(14 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">bias² + variance, relative</text>')
    parts.append(f'<polyline class="front" points="{path(pareto(shown))}"/>')
    color_of = colors(shown)
    for name in dict.fromkeys(m.setting.name for m in shown):
        members = sorted((m for m in shown if m.setting.name == name), key=lambda m: m.spp)
        color = color_of[members[0].setting.factor]
        parts.append(f'<polyline fill="none" stroke="{color}" stroke-opacity="0.5" points="{path(members)}"/>')
        for m in members:
            label = f"{m.setting.name}, {m.spp} spp: {m.seconds:.3g} s, bias² {m.bias2.value:.1e}, variance {m.variance.value:.1e}"
            parts.append(f'<circle cx="{x(m.seconds):.1f}" cy="{y(m.error):.1f}" r="{5 if m.setting.factor == OWN else 4}" fill="{color}">'
                         f"<title>{escape(label)}</title></circle>")
    for m in pareto(shown):
        parts.append(f'<text x="{x(m.seconds) + 8:.1f}" y="{y(m.error) - 7:.1f}">{escape(f"{m.setting.name}, {m.spp} spp")}</text>')
    for i, (factor, color) in enumerate(color_of.items()):
        top = TOP + 14 + 20 * i
        parts.append(f'<circle cx="{WIDTH - RIGHT + 20}" cy="{top - 4}" r="5" fill="{color}"/>'
                     f'<text x="{WIDTH - RIGHT + 32}" y="{top}">{escape(factor)}</text>')
    top = TOP + 14 + 20 * len(color_of)
    parts.append(f'<line class="front" x1="{WIDTH - RIGHT + 12}" x2="{WIDTH - RIGHT + 28}" y1="{top - 4}" y2="{top - 4}"/>'
                 f'<text x="{WIDTH - RIGHT + 32}" y="{top}">Pareto front</text></svg>')
    return "".join(parts)
