"""The study of a small scene: every file is written, and a clamp is found out."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lumiere.scene.load import load
from lumiere.scene.model import Scene
from lumiere.tradeoff.settings import settings

SCENE: dict[str, Any] = {"scene": {
    "camera": {"position": [0, 1, 4], "look_at": [0, 0.5, 0]}, "film": {"width": 12, "height": 12}, "integrator": {"max_depth": 4},
    "geometry": [{"type": "plane", "material": {"type": "lambert", "albedo": 0.8}}, {"type": "sphere", "position": [0, 0.5, 0], "radius": 0.5}],
    "lights": [{"type": "area", "position": [0, 3, 0], "normal": [0, -1, 0], "radius": 0.2, "radiance": 50}]}}


def _scene() -> Scene:
    return load(SCENE)


def test_every_factor_is_in_the_grid() -> None:
    factors = {s.factor for s in settings(_scene(), 1.0)}
    assert factors == {"maths", "max_depth", "russian_roulette_depth", "light_sampling", "sampler", "clamp_indirect", "accelerator"}


def test_texture_filters_are_in_the_grid_where_there_are_pictures(tmp_path: Path) -> None:
    import PIL.Image

    PIL.Image.fromarray(np.zeros((2, 2, 3), np.uint8)).save(tmp_path / "a.png")
    textured = {"type": "lambert", "albedo": {"type": "image", "file": str(tmp_path / "a.png")}}
    scene = load({"scene": {**SCENE["scene"], "materials": {"a": textured}}})
    found = [s for s in settings(scene, 1.0) if s.factor == "texture filter"]
    assert [s.value for s in found] == ["nearest", "mipmap"]
    assert found[0].change(scene).materials["a"].albedo.filter == "nearest"
    assert scene.materials["a"].albedo.filter == "bilinear"


def test_energy_compensation_is_in_the_grid_where_a_material_knows_it() -> None:
    def values(material: dict[str, Any], **integrator: bool) -> list[str]:
        scene = load({"scene": {**SCENE["scene"], "materials": {"a": material}, "integrator": integrator}})
        return [s.value for s in settings(scene, 1.0) if s.factor == "energy_compensation"]

    rough = {"type": "conductor", "roughness": 0.5}
    assert values(rough) == ["off"] and values(rough, energy_compensation=False) == ["on"]
    assert values({"type": "lambert"}) == []


@pytest.mark.usefixtures("device")
def test_a_clamp_has_a_bias_and_the_files_agree(tmp_path: Path, device: Any) -> None:
    from lumiere.tradeoff import measure
    from lumiere.tradeoff.report import write
    from lumiere.tradeoff.settings import Setting, own

    scene = _scene()
    runner = measure.Runner(None, 1000.0, lambda step: None)
    strict, _, job = runner.pictures(scene, own(), 16, 5000, 8)
    reference = measure.Reference(strict.mean(axis=0, dtype=np.float64), strict.var(axis=0, ddof=1, dtype=np.float64) / 8, strict)
    result = measure.Study(scene, job.device.name, reference, "rendered", measure.metrics.weights(reference.mean))
    clamp = Setting("clamp_indirect", "0.01", lambda s: replace(s, integrator=replace(s.integrator, clamp_indirect=0.01)), unbiased=False)
    for setting in (own(), clamp):
        pictures, seconds, job = runner.pictures(scene, setting, 4, 1000, measure.SEEDS)
        result.measurements.append(measure._measured(setting, 4, pictures, seconds, result, job))
    plain, clamped = result.measurements
    assert clamped.bias2.differs_from_zero and clamped.bias2.value > 0.0
    assert plain.bias2.value < 0.1 * clamped.bias2.value
    assert clamped.variance.value < plain.variance.value

    for path in write(result, tmp_path):
        assert path.stat().st_size > 0
    rows = list(csv.DictReader((tmp_path / "table.csv").open(encoding="utf-8")))
    told = json.loads((tmp_path / "table.json").read_text(encoding="utf-8"))
    assert [float(row["bias²"]) for row in rows] == [m["bias²"] for m in told["measurements"]]
    assert {c["goal"] for c in told["choices"]} == {"10 s", "relMSE 1e-03"}
    html = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "src=\"data:image/png" in html and "<svg" in html and "http" not in html.replace("http-equiv", "")
