"""The study as table.txt, table.csv and table.json."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import Any

from lumiere.film.atomic import replacing
from lumiere.tradeoff.advise import Choice, choices
from lumiere.tradeoff.measure import SEEDS, Measurement, Study
from lumiere.tradeoff.metrics import FLOOR, TRIMMED
from lumiere.tradeoff.page import page

COLUMNS = ("setting", "spp", "seconds", "relMSE", "relMSE trimmed", "FLIP", "bias²", "± bias²", "variance", "± variance", "efficiency", "slope",
           "accelerator")

DEFINITIONS = (
    f"seconds: median of {SEEDS} renders of independent seeds, without loading and building. A change is timed beside the scene's own settings, "
    "and its seconds are given as if the machine had run at the speed at which those were first timed.",
    f"relMSE: mean of (I − R)² / (R² + {FLOOR:g} m²) over values I of the picture and R of the reference, m the reference's mean; mean of the seeds. "
    f"trimmed: without the {100 * TRIMMED:g} % of the pixels that are worst in each picture.",
    "FLIP: mean HDR-ꟻLIP of the first seed (Andersson et al. 2021).",
    "bias², variance: the same relative mean for (expected picture − R)², less the variances of both sides, and for the variance of one picture; "
    "± is half of the 95 % interval (jackknife over the seeds and the reference's). A bias² within ± of 0 is not told from none; it can be below 0.",
    "efficiency: 1 / (variance × seconds).   slope: of log √(bias² + variance) against log seconds over the setting's spp; −0.5 is Monte Carlo's.",
    "accelerator: seconds that building it took, once a scene; the choice for a time counts them.",
)


def row(m: Measurement) -> dict[str, Any]:
    """The measurement by column."""
    return dict(zip(COLUMNS, (
        m.setting.name, m.spp, m.seconds, m.rel_mse, m.rel_mse_trimmed, m.flip, m.bias2.value, m.bias2.half_width, m.variance.value,
        m.variance.half_width, m.efficiency, m.slope, m.accelerator_seconds), strict=True))


def _text(value: Any) -> str:
    if value is None:
        return "–"
    if isinstance(value, float):
        return f"{value:.3g}" if 1e-3 <= abs(value) < 1e5 or value == 0.0 else f"{value:.2e}"
    return str(value)


def headline(study: Study) -> list[str]:
    """What was measured, against what."""
    film = study.scene.film
    x0, y0, x1, y1 = film.window
    return [f"{study.scene.path or 'scene'}: {x1 - x0} × {y1 - y0} on {study.device}, {study.seconds:.0f} s in all",
            f"reference {study.reference_text}; its own relMSE is {study.reference_error:.2g}"]


def advice(choice: Choice) -> str:
    """A choice in a line."""
    if choice.measurement is None:
        return f"for {choice.goal}: none; {choice.why}"
    return (f"for {choice.goal}: {choice.measurement.setting.name} with {choice.spp} spp, {choice.seconds:.3g} s, relMSE {choice.error:.2g}: "
            f"{choice.why}")


def table_text(study: Study) -> str:
    """The table for a terminal, with its definitions, the advice and what was left out."""
    rows = [COLUMNS, *([_text(value) for value in row(m).values()] for m in study.measurements)]
    widths = [max(len(r[i]) for r in rows) for i in range(len(COLUMNS))]
    lines = ["  ".join([r[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(r[1:], widths[1:], strict=True))]) for r in rows]
    parts = [*headline(study), "", lines[0], "-" * len(lines[0]), *lines[1:], "", *(advice(c) for c in choices(study)), "", *DEFINITIONS]
    if all(m.flip is None for m in study.measurements):
        parts.append("FLIP was left out: get it with `pip install flip-evaluator`.")
    parts += [f"left out: {text}" for text in study.left_out]
    return "\n".join(parts) + "\n"


def table_csv(study: Study) -> str:
    """The table, a measurement a line."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for m in study.measurements:
        writer.writerow({key: "" if value is None else value for key, value in row(m).items()})
    return text.getvalue()


def table_json(study: Study) -> str:
    """Everything but the pictures."""
    def finite(value: Any) -> Any:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    return json.dumps({
        "scene": str(study.scene.path) if study.scene.path else None, "device": study.device, "seeds": SEEDS, "seconds": study.seconds,
        "reference": {"text": study.reference_text, "relMSE": study.reference_error},
        "measurements": [{key: finite(value) for key, value in row(m).items()} for m in study.measurements],
        "choices": [{"goal": c.goal, "setting": c.measurement.setting.name if c.measurement else None, "spp": c.spp, "seconds": finite(c.seconds),
                     "relMSE": c.error, "why": c.why} for c in choices(study)],
        "left_out": study.left_out, "definitions": DEFINITIONS}, indent=2, ensure_ascii=False) + "\n"


def write(study: Study, folder: Path) -> list[Path]:
    """table.txt, table.csv, table.json and index.html in ``folder``, which is made where it is not there."""
    folder.mkdir(parents=True, exist_ok=True)
    notes = [*DEFINITIONS, *(f"Left out: {text}" for text in study.left_out)]
    if all(m.flip is None for m in study.measurements):
        notes.append("FLIP was left out: get it with `pip install flip-evaluator`.")
    texts = {"table.txt": table_text(study), "table.csv": table_csv(study), "table.json": table_json(study),
             "index.html": page(study, headline(study), [advice(c) for c in choices(study)],
                                COLUMNS, [[_text(v) for v in row(m).values()] for m in study.measurements], notes)}
    for name, text in texts.items():
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8")
    return [folder / name for name in texts]
