"""The proof sheet of the materials: one page of HTML, with a picture of each example and what the BSDF tests measure of it.

    python tools/proof_sheet.py sheet.html                    # every kind, plug-ins too, on every OpenCL device present
    python tools/proof_sheet.py --kind principled sheet.html

Kinds that know energy compensation are measured with it, and without it as «textbook». A mix, which has no BSDF of its own, is measured by its
picture. The measurements are those of tests/bsdf and tests/material, whose functions it calls. The command's status is 1 where something failed.
"""

from __future__ import annotations

import argparse
import base64
import dataclasses
import html
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import pytest

import lumiere
from lumiere.bsdf import MATERIALS, Material
from lumiere.bsdf.mix import Mix
from tests.bsdf import test_extremes, test_sampling
from tests.bsdf.study import ABOVE, BELOW, EXAMPLES, TEXTBOOK, study
from tests.material import test_energy, test_mix
from tests.statistics import chi_square

STYLE = """
body { font: 14px/1.4 system-ui, sans-serif; margin: 2em; color: #222; background: #fff }
table { border-collapse: collapse; margin: .5em 0 2em } td, th { border: 1px solid #ccc; padding: .25em .6em; text-align: right }
th { background: #f2f2f2 } .pass { background: #e2f4e2 } .fail { background: #f6c8c8; font-weight: bold } .none { color: #999 }
.example { display: flex; gap: 1em; align-items: flex-start } img { width: 128px; height: 128px }
"""


@dataclass
class Cell:
    """A measurement: what it says and whether it is as it should be (None: there is nothing to measure)."""

    text: str
    passed: bool | None = None

    def html(self) -> str:
        shown = {True: "pass", False: "fail", None: "none"}[self.passed]
        return f'<td class="{shown}">{html.escape(self.text)}</td>'


@dataclass
class Sheet:
    """Counts what it is made of."""

    parts: list[str] = field(default_factory=list)
    passed: int = 0
    failed: int = 0

    def cell(self, cell: Cell) -> str:
        """The cell, counted."""
        self.passed += cell.passed is True
        self.failed += cell.passed is False
        return cell.html()


def checked(test: Callable[..., None], *arguments: Any, text: str = "") -> Cell:
    """A test's verdict, with ``text`` in the cell where it is given."""
    try:
        test(*arguments)
    except pytest.skip.Exception:
        return Cell("—")
    except AssertionError:
        return Cell(text or "fails", False)
    return Cell(text or "holds", True)


def incidence(device: Any, name: str, view: str) -> Iterator[Cell]:
    """The cells of an example seen from one direction: those of COLUMNS."""
    measured = study(device, name, view)
    observed, expected = test_sampling.counts(measured)
    yield checked(test_sampling.test_samples_follow_the_density, device, name, view, text=f"p = {chi_square(observed, expected):.3f}")
    yield checked(test_sampling.test_density_is_normalised, device, name, view, text=f"{measured.pdf.sum():.4f}")
    yield Cell("—") if measured.material.purely_specular else checked(test_sampling.test_sample_agrees_with_eval_and_pdf, device, name, view)
    total, _ = measured.energy()
    yield checked(test_sampling.test_weights_estimate_the_energy, device, name, view)
    yield checked(test_sampling.test_no_energy_is_made, device, name, view, text=f"{total.max():.4f}")
    yield checked(test_sampling.test_samples_are_well_formed, device, name, view)


COLUMNS = ("view", "χ²", "∫ pdf", "weight = eval / pdf", "mean weight = ∫ f cosθ", "albedo ≤ 1", "finite, unit, positive")


def picture(device: Any, material: Material, size: int, spp: int, *, compensation: bool = True) -> str:
    """A sphere of the material on a checkered floor, as a data URL."""
    scene = lumiere.load({"scene": {
        "film": {"width": size, "height": size}, "integrator": {"energy_compensation": compensation},
        "camera": {"position": [0, 1.2, 5], "look_at": [0, 0, 0], "fov": 30},
        "materials": {"proof": {"type": "lambert"}, "floor": {"type": "lambert", "albedo": {"type": "checker", "a": 0.6, "b": 0.1, "scale": 8}}},
        "geometry": [{"type": "sphere", "position": [0, 0, 0], "radius": 1, "material": "proof"},
                     {"type": "rectangle", "transform": [{"scale": [4, 4, 1]}, {"rotate": {"axis": [1, 0, 0], "angle": -90}}, {"translate": [0, -1, 0]}],
                      "material": "floor"}],
        "lights": [{"type": "environment", "radiance": 0.4}, {"type": "area", "position": [3, 4, 3], "radius": 0.8, "radiance": 20}]}})
    scene.geometry[0].material = material
    image = lumiere.render(scene, spp=spp, device=device.name)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sphere.png"
        image.save(path)
        return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode()


def described(material: Material, name: str = "") -> str:
    """The values that are not their defaults; whether the example ``name`` is without energy compensation."""
    own = [f for f in dataclasses.fields(material) if f.name in type(material).__annotations__]
    changed = [f"{f.name} {getattr(material, f.name)}" for f in own if getattr(material, f.name) != f.default]
    return (", ".join(changed) or "as it is by default") + ("; textbook" if name.endswith(TEXTBOOK) else "")


def furnace(device: Any, material: Material) -> Cell:
    """The largest distance from 1 of what a white material scatters, compensated, over the views."""
    try:
        test_energy.test_white_furnace(device, material)
        passed = True
    except AssertionError:
        passed = False
    worst = max(float(np.abs(test_energy.energy(device, material, wo, 1 << 14)[0] - 1.0).max()) for wo in ABOVE.values())
    return Cell(f"{100.0 * worst:.2f} %", passed)


def kind_part(sheet: Sheet, device: Any, kind: str, views: list[str], size: int, spp: int) -> None:
    """The part of one kind on one device."""
    examples = {name: m for name, m in EXAMPLES.items() if m.type == kind}
    doc = html.escape((MATERIALS.kinds()[kind].__doc__ or "").strip().split("\n\n")[0])
    sheet.parts.append(f"<h2>{kind}</h2><p>{doc}</p>")
    for name, material in examples.items():
        rows = ["".join(f"<th>{column}</th>" for column in COLUMNS)]
        for view in [v for v in views if v in ABOVE or not material.reflective]:
            rows.append(f"<td>{view}°</td>" + "".join(sheet.cell(cell) for cell in incidence(device, name, view)))
        if not material.purely_specular:
            rows.append("<td>reciprocity</td>" + sheet.cell(checked(test_sampling.test_reciprocity, device, name)))
        table = "".join(f"<tr>{row}</tr>" for row in rows)
        drawn = picture(device, material, size, spp, compensation=not name.endswith(TEXTBOOK))
        sheet.parts.append(f'<h3>{html.escape(described(material, name))}</h3><div class="example">'
                           f'<img src="{drawn}" alt="{name}"><table>{table}</table></div>')
    rows = ["<th>device kind</th><th>extremes of all parameters, grazing angles: finite, not negative</th>"]
    rows += [f"<td>{k}</td>" + sheet.cell(checked(test_extremes.test_extremes, device, k))
             for k, members in test_extremes.DEVICE_KINDS.items() if members[0].type == kind]
    sheet.parts.append("<table>" + "".join(f"<tr>{row}</tr>" for row in rows) + "</table>")
    white = [m for m in test_energy.FURNACES if m.type == kind]
    if white:
        rows = ["<th>white furnace, compensated</th><th>largest distance from 1</th>"]
        rows += [f"<td>{html.escape(described(m))}</td>" + sheet.cell(furnace(device, m)) for m in white]
        sheet.parts.append("<table>" + "".join(f"<tr>{row}</tr>" for row in rows) + "</table>")


def mix_part(sheet: Sheet, device: Any, size: int, spp: int) -> None:
    """The part of mixes on one device: their pictures are the mixtures of their parts' pictures."""
    sheet.parts.append(f"<h2>mix</h2><p>{html.escape((Mix.__doc__ or '').strip().splitlines()[0])}</p>")
    rows = ["<th>weight</th><th>of the same kind</th><th>of another kind</th>"]
    for weight in (0.0, 0.3, 1.0):
        parts = (test_mix.RED, test_mix.METAL)
        rows.append(f"<td>{weight}</td>" + "".join(sheet.cell(checked(test_mix.test_a_mix_is_the_mixture, device, weight, part)) for part in parts))
    rows.append("<td>in a mix</td>" + sheet.cell(checked(test_mix.test_mixes_in_mixes, device)) + "<td></td>")
    rows.append("<td>textured</td>" + sheet.cell(checked(test_mix.test_a_textured_weight, device)) + "<td></td>")
    gold, plastic = MATERIALS.kinds()["conductor"](metal="gold", roughness=0.3), MATERIALS.kinds()["plastic"](albedo=(0.1, 0.3, 0.6))
    table = "".join(f"<tr>{row}</tr>" for row in rows)
    sheet.parts.append(f'<div class="example"><img src="{picture(device, Mix(a=gold, b=plastic), size, spp)}" alt="mix"><table>{table}</table></div>')


def devices() -> list[Any]:
    """Every OpenCL device that can be used."""
    from lumiere.device.select import list_devices

    return [info.device for info in list_devices() if info.index is not None]


def make(kinds: list[str], views: list[str], size: int = 96, spp: int = 64, on: list[Any] | None = None) -> tuple[str, int, int]:
    """The page, and how many of its cells passed and failed."""
    sheet = Sheet()
    for device in devices() if on is None else on:
        sheet.parts.append(f"<h1>{html.escape(device.name.strip())}, {html.escape(device.platform.name)}</h1>")
        for kind in kinds:
            if any(m.type == kind for m in EXAMPLES.values()):
                kind_part(sheet, device, kind, views, size, spp)
            elif kind == Mix.type:
                mix_part(sheet, device, size, spp)
    head = f"<p>{sheet.passed} hold, {sheet.failed} fail. Lumière {lumiere.__version__}.</p>"
    begin = f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Materials: proof sheet</title><style>{STYLE}</style>'
    return f"{begin}{head}{''.join(sheet.parts)}</html>", sheet.passed, sheet.failed


def main() -> int:
    """Writes the page; 1 where something failed."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--kind", action="append", choices=list(MATERIALS.kinds()), help="only this kind (may be given several times)")
    parser.add_argument("--view", action="append", choices=[*ABOVE, *BELOW], help="only this angle of incidence, degrees")
    arguments = parser.parse_args()
    page, passed, failed = make(arguments.kind or list(MATERIALS.kinds()), arguments.view or [*ABOVE, *BELOW])
    arguments.output.write_text(page, encoding="utf-8")
    print(f"{arguments.output}: {passed} hold, {failed} fail")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
