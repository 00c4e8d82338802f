"""The profile's charts, as SVG."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from html import escape
from typing import Any

from lumiere.profile.bins import RoundBin
from lumiere.profile.observe import Count, Launch

WIDTH, LEFT, RIGHT = 1100, 110, 20

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5c00", "#8031a7", "#b00020", "#000000")
"""Of the stages, in the order of their launches; the first six after Okabe & Ito 2008, to be told apart by the colour-blind too."""

COLUMNS = 220
"""Of the timeline of the whole render."""

LANE = 24
"""Height of a stage's lane."""


def colors(stages: Sequence[str]) -> dict[str, str]:
    """Stage → colour."""
    return {stage: COLORS[i % len(COLORS)] for i, stage in enumerate(stages)}


def _ticks(high: float, wanted: int = 6) -> list[float]:
    """Round numbers from 0 to ``high``."""
    if high <= 0.0:
        return [0.0]
    power = 10.0 ** math.floor(math.log10(high / wanted))
    step = next(s * power for s in (1.0, 2.0, 5.0, 10.0) if s * power * wanted >= high)
    return [i * step for i in range(int(high / step) + 1)]


def _svg(height: int, parts: Sequence[str], label: str) -> str:
    return f'<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{escape(label)}">{"".join(parts)}</svg>'


def _x_axis(y: float, high: float, x: Callable[[float], float], text: Callable[[float], str], top: float, title: str) -> list[str]:
    parts = []
    for tick in _ticks(high):
        parts.append(f'<line class="grid" x1="{x(tick):.1f}" x2="{x(tick):.1f}" y1="{top}" y2="{y}"/>'
                     f'<text x="{x(tick):.1f}" y="{y + 15}" text-anchor="middle">{text(tick)}</text>')
    return [*parts, f'<text x="{WIDTH - RIGHT}" y="{y + 30}" text-anchor="end">{escape(title)}</text>']


def shares(seconds: dict[str, float]) -> str:
    """One bar: ``seconds`` by name, as parts of their sum."""
    total = sum(seconds.values()) or 1.0
    color_of = colors([name for name in seconds if name != "idle"]) | {"idle": "#dddddd"}
    parts, at = [], 0.0
    for name, value in seconds.items():
        width = WIDTH * value / total
        label = f"{name} {100.0 * value / total:.0f} %"
        parts.append(f'<rect x="{at:.2f}" y="0" width="{width:.2f}" height="30" fill="{color_of[name]}"><title>{escape(label)}, '
                     f'{1e3 * value:.4g} ms</title></rect>')
        if width > 8 * len(label):
            parts.append(f'<text class="{"dark" if name == "idle" else "on"}" x="{at + width / 2:.1f}" y="20" text-anchor="middle">'
                         f'{escape(label)}</text>')
        at += width
    return _svg(30, parts, "share of each stage")


def whole(launches: Sequence[Launch], stages: Sequence[str]) -> str:
    """The whole render from left to right: how each slice of time was divided among the stages; white is idle."""
    span = max((launch.end for launch in launches), default=0.0) or 1.0
    busy = [dict.fromkeys(stages, 0.0) for _ in range(COLUMNS)]
    slice_ = span / COLUMNS
    for launch in launches:
        for column in range(min(COLUMNS - 1, int(launch.start / slice_)), min(COLUMNS - 1, int(launch.end / slice_)) + 1):
            busy[column][launch.stage] += max(0.0, min(launch.end, (column + 1) * slice_) - max(launch.start, column * slice_))
    top, height = 6, 150
    color_of = colors(stages)

    def x(seconds: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * seconds / span

    parts = _x_axis(top + height, span, x, lambda t: f"{1e3 * t:.4g}", top, "ms since the first launch")
    for column, times in enumerate(busy):
        bottom = float(top + height)
        for stage, value in times.items():
            part = height * min(1.0, value / slice_)
            if part > 0.05:
                bottom -= part
                parts.append(f'<rect x="{x(column * slice_):.2f}" y="{bottom:.2f}" width="{x(slice_) - x(0.0) + 0.05:.2f}" height="{part:.2f}" '
                             f'fill="{color_of[stage]}"><title>{escape(stage)}: {100.0 * value / slice_:.0f} % of this slice</title></rect>')
    for share, text in ((0.0, "0 %"), (0.5, "50 %"), (1.0, "100 %")):
        parts.append(f'<text x="{LEFT - 6}" y="{top + height * (1.0 - share) + 4:.1f}" text-anchor="end">{text}</text>')
    return _svg(top + height + 36, parts, "how each slice of time was divided among the stages")


def lanes(launches: Sequence[Launch], stages: Sequence[str], counts: dict[tuple[int, int, str], Count]) -> str:
    """Each launch as a bar in its stage's lane."""
    begin = min((launch.start for launch in launches), default=0.0)
    span = max((launch.end for launch in launches), default=0.0) - begin or 1.0
    color_of, height = colors(stages), LANE * len(stages)

    def x(seconds: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * seconds / span

    parts = _x_axis(height + 4, span, x, lambda t: f"{1e3 * (begin + t):.4g}", 0, "ms since the first launch")
    for i, stage in enumerate(stages):
        parts.append(f'<text x="{LEFT - 6}" y="{i * LANE + 16}" text-anchor="end">{escape(stage)}</text>'
                     f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{(i + 1) * LANE}" y2="{(i + 1) * LANE}"/>')
    for launch in launches:
        row = stages.index(launch.stage)
        count = counts.get((launch.batch, launch.round, launch.stage), Count(0, 0, {})).items
        parts.append(f'<rect x="{x(launch.start - begin):.2f}" y="{row * LANE + 3}" width="{max(0.4, x(launch.seconds) - x(0.0)):.2f}" '
                     f'height="{LANE - 6}" fill="{color_of[launch.stage]}"><title>{escape(launch.stage)}, batch {launch.batch}, '
                     f'round {launch.round}: {1e3 * launch.seconds:.4g} ms, {count:,} items</title></rect>')
    return _svg(height + 40, parts, "each launch in its stage's lane")


def population(parts_of: Sequence[RoundBin]) -> str:
    """Paths alive by round as bars, with the paths that were started as the darker part."""
    top, height = 8, 200
    most = max((part.paths for part in parts_of), default=0.0) or 1.0
    rounds = parts_of[-1].last + 1 if parts_of else 1

    def x(number: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * number / rounds

    def y(paths: float) -> float:
        return top + height * (1.0 - paths / most)

    parts = [f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(t):.1f}" y2="{y(t):.1f}"/>'
             f'<text x="{LEFT - 6}" y="{y(t) + 4:.1f}" text-anchor="end">{t:,.0f}</text>' for t in _ticks(most, 4)]
    parts += _x_axis(top + height, rounds, x, lambda t: f"{t:.0f}" if t == int(t) else "", top + height, "round")
    batch = 0
    for part in parts_of:
        width = max(0.3, x(part.last + 1) - x(part.first) - (1.0 if len(parts_of) <= 150 else 0.0))
        tip = (f"round {part.label}, batch {part.batch}: {part.paths:,.0f} paths alive, {part.items['generate']:,.0f} of them new"
               + (f", {part.items['connect']:,.0f} shadow rays" if "connect" in part.items else "")
               + f", {1e3 * sum(part.seconds.values()):.4g} ms of kernels")
        for value, style in ((part.paths, "alive"), (part.items["generate"], "new")):
            parts.append(f'<rect class="{style}" x="{x(part.first):.2f}" y="{y(value):.2f}" width="{width:.2f}" '
                         f'height="{top + height - y(value):.2f}"><title>{escape(tip)}</title></rect>')
        if part.batch != batch:
            batch = part.batch
            parts.append(f'<line class="batch" x1="{x(part.first):.1f}" x2="{x(part.first):.1f}" y1="{top}" y2="{top + height}"/>')
    return _svg(top + height + 36, parts, "paths alive by round")


def bounces(rows: Sequence[dict[str, Any]], stages: Sequence[str]) -> str:
    """Rays and shadow rays of each bounce as a pair of bars, and below how the bounce's time was divided among the stages."""
    top, height, gap = 18, 150, 46
    most = max((max(row["extend"]["rays"], row["connect"]["rays"]) for row in rows), default=0) or 1
    longest = max((sum(row["seconds"].values()) for row in rows), default=0.0) or 1.0
    width = (WIDTH - LEFT - RIGHT) / max(1, len(rows))
    color_of = colors(stages)
    parts = []
    for base, high, title, text in ((top + height, most, "rays", lambda t: f"{t:,.0f}"),
                                    (top + 2 * height + gap, 1e3 * longest, "ms", lambda t: f"{t:.4g}")):
        parts.append(f'<text x="{LEFT - 6}" y="{base - height - 6}" text-anchor="end">{title}</text>')
        for tick in _ticks(high, 4):
            y = base - height * tick / high
            parts.append(f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}"/>'
                         f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{text(tick)}</text>')
    for i, row in enumerate(rows):
        x, base = LEFT + i * width, float(top + height)
        for j, (stage, kind, style) in enumerate((("extend", "rays", "alive"), ("connect", "shadow rays", "new"))):
            part = row[stage]
            tall = height * part["rays"] / most
            visited = "" if part["nodes_per_ray"] is None else f"; each visits {part['nodes_per_ray']:.3g} nodes, {part['primitives_per_ray']:.3g} primitives"
            parts.append(f'<rect class="{style}" x="{x + width * (0.15 + 0.35 * j):.2f}" y="{base - tall:.2f}" width="{0.35 * width:.2f}" '
                         f'height="{tall:.2f}"><title>bounce {row["bounce"]}: {part["rays"]:,} {kind}{visited}</title></rect>')
        parts.append(f'<text x="{x + width / 2:.1f}" y="{base + 15}" text-anchor="middle">{row["bounce"]}</text>')
        base = float(top + 2 * height + gap)
        parts.append(f'<text x="{x + width / 2:.1f}" y="{base + 15}" text-anchor="middle">{row["bounce"]}</text>')
        for stage in stages:
            value = row["seconds"].get(stage, 0.0)
            tall = height * value / longest
            base -= tall
            parts.append(f'<rect x="{x + 0.15 * width:.2f}" y="{base:.2f}" width="{0.7 * width:.2f}" height="{tall:.2f}" fill="{color_of[stage]}">'
                         f'<title>bounce {row["bounce"]}: {escape(stage)} {1e3 * value:.4g} ms</title></rect>')
    return _svg(top + 2 * height + gap + 24, parts, "rays and time by bounce")
