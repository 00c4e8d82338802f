"""The study as one HTML page that needs no other file."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from html import escape

import numpy as np

from lumiere.film.encode import encode8
from lumiere.tradeoff.measure import Measurement, Study
from lumiere.tradeoff.plot import colors, pareto, plot

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 1180px; padding: 0 1em; color: #1a1a1a; background: #fff }
h1 { font-size: 1.4em } h2 { font-size: 1.1em; margin-top: 2em }
svg { width: 100%; max-width: 920px } svg text { font: 12px system-ui, sans-serif; fill: #333 }
.grid { stroke: #e4e4e4 } .front { stroke: #999; stroke-width: 2; stroke-dasharray: 6 4; fill: none }
table { border-collapse: collapse; font-size: 13px } th, td { padding: 2px 9px; text-align: right; white-space: nowrap }
td { border-bottom: 1px solid #eee }
th:first-child, td:first-child { text-align: left } tr.front { background: #f2f8f2 } .scroll { overflow-x: auto }
.pictures { display: flex; flex-wrap: wrap; gap: 14px } figure { margin: 0 } figcaption { font-size: 12px; max-width: 400px }
img { image-rendering: pixelated; width: 130px } .advice { background: #f4f6fb; padding: .5em 1em; border-left: 4px solid #0072b2 }
.dot { display: inline-block; width: .7em; height: .7em; border-radius: 50%; margin-right: .4em }
"""

_HEAT = np.array([[0, 0, 4], [40, 11, 84], [101, 21, 110], [159, 42, 99], [212, 72, 66], [245, 125, 21], [250, 193, 39], [252, 255, 164]], float)
"""Colours of an error from 0 to 1, dark to bright."""

ERROR_SHOWN = 1.0
"""Relative error that is brightest in the error maps; a tenth of it in the maps of the seeds' mean."""


def _png(pixels: np.ndarray) -> str:
    import PIL.Image

    data = io.BytesIO()
    PIL.Image.fromarray(pixels).save(data, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(data.getvalue()).decode()


def heat(values: np.ndarray) -> np.ndarray:
    """uint8 (h, w, 3) of values in [0, 1]."""
    at = np.clip(values, 0.0, 1.0) * (len(_HEAT) - 1)
    low = np.minimum(at.astype(int), len(_HEAT) - 2)
    part = (at - low)[..., None]
    return (_HEAT[low] * (1.0 - part) + _HEAT[low + 1] * part + 0.5).astype(np.uint8)


def signed(values: np.ndarray) -> np.ndarray:
    """uint8 (h, w, 3) of values in [−1, 1]: blue below 0, white, red above."""
    v = np.clip(values, -1.0, 1.0)[..., None]
    ends = np.where(v > 0.0, [178.0, 24.0, 43.0], [33.0, 102.0, 172.0])
    return (255.0 + np.abs(v) * (ends - 255.0) + 0.5).astype(np.uint8)


def _figure(pictures: Sequence[np.ndarray], caption: str) -> str:
    images = "".join(f'<img src="{_png(p)}" alt="">' for p in pictures)
    return f"<figure>{images}<figcaption>{escape(caption)}</figcaption></figure>"


def _maps(m: Measurement, study: Study) -> list[np.ndarray]:
    film, reference = study.scene.film, study.reference.mean
    relative = np.sqrt((study.weight * (m.example - reference) ** 2).mean(axis=-1))
    of_mean = ((m.mean - reference) * np.sqrt(study.weight)).mean(axis=-1)
    return [encode8(m.example, film.exposure, film.tonemap), heat(relative / ERROR_SHOWN), signed(of_mean / (0.1 * ERROR_SHOWN))]


def page(study: Study, headline: Sequence[str], advice: Sequence[str], columns: Sequence[str], rows: Sequence[Sequence[str]],
         notes: Sequence[str]) -> str:
    """The HTML text. ``rows`` are those of the measurements, in their order."""
    front = {id(m) for m in pareto(study.measurements)}
    color_of = colors(study.measurements)
    body = ["<h1>Speed against accuracy</h1>", *(f"<p>{escape(line)}</p>" for line in headline)]
    body += [f'<p class="advice">{escape(text[:1].upper() + text[1:])}</p>' for text in advice]
    body += ["<h2>Error against time</h2>", plot(study.measurements)]
    cells = []
    for m, values in zip(study.measurements, rows, strict=True):
        dot = f'<span class="dot" style="background:{color_of[m.setting.factor]}"></span>'
        cells.append(f"<tr{' class=front' if id(m) in front else ''}><td>{dot}{escape(values[0])}</td>"
                     + "".join(f"<td>{escape(v)}</td>" for v in values[1:]) + "</tr>")
    body += ["<h2>Table</h2><p>Settings on the Pareto front are tinted.</p>", '<div class="scroll"><table><tr>',
             *(f"<th>{escape(c)}</th>" for c in columns), "</tr>", *cells, "</table></div>",
             "<ul>", *(f"<li>{escape(n)}</li>" for n in notes), "</ul>"]
    film = study.scene.film
    body += ["<h2>Pictures</h2><p>Of each setting at its largest spp: the first seed; its relative error (black: 0, bright: "
             f"{ERROR_SHOWN:g} and above); and the mean of the seeds less the reference (blue: {-0.1 * ERROR_SHOWN:g}, white: 0, red: "
             f"{0.1 * ERROR_SHOWN:g}), where bias shows as areas of one colour.</p>", '<div class="pictures">',
             _figure([encode8(study.reference.mean, film.exposure, film.tonemap)], "reference")]
    largest: dict[str, Measurement] = {}
    for m in study.measurements:
        if m.setting.name not in largest or m.spp >= largest[m.setting.name].spp:
            largest[m.setting.name] = m
    body += [_figure(_maps(m, study), f"{m.setting.name}, {m.spp} spp: relMSE {m.rel_mse:.2g}, {m.seconds:.3g} s") for m in largest.values()]
    return (f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Speed against accuracy: {escape(str(study.scene.path or "scene"))}</title>'
            f"<style>{STYLE}</style><body>{''.join(body)}</div></body></html>\n")
