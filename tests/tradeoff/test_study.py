"""The study of a small scene: every file is written, and a clamp is found out."""

from __future__ import annotations

import csv
import importlib.util
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lumiere.compile.scene import compile_scene
from lumiere.rendering import Render
from lumiere.scene.load import load
from lumiere.scene.model import Scene
from lumiere.tradeoff import measure
from lumiere.tradeoff.advise import choices
from lumiere.tradeoff.report import COLUMNS, write
from lumiere.tradeoff.settings import OWN, Setting, layouts, own, settings

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


def test_maths_is_in_the_grid_as_a_whole_and_by_stage() -> None:
    found = {s.value: s.overrides for s in settings(_scene(), 1.0) if s.factor == "maths"}
    assert {"mad", "relaxed", *(f"{name} in {stage}" for name in ("mad", "relaxed") for stage in ("extend", "shade", "connect"))} == set(found)
    only_shade = found["mad in shade"]
    assert only_shade.options_of("shade") == ("-cl-mad-enable",) and only_shade.options_of("extend") == ()


def test_every_layout_is_in_the_grid_and_every_build_quality() -> None:
    found = [s.value for s in settings(_scene(), 1.0) if s.factor == "accelerator"]
    assert found == [*(name for name in layouts() if name != "flat"), "of low build quality", "with spatial splits"]


@pytest.mark.parametrize("wide", [True, False])
def test_every_accelerator_of_the_grid_takes_a_scene(wide: bool) -> None:
    boxes = load({"scene": {"geometry": [{"type": "box"}, {"type": "box", "transform": [{"translate": [3, 0, 0]}]}, *SCENE["scene"]["geometry"]]}})
    for setting in settings(boxes, 1.0):
        if setting.factor == "accelerator":
            compiled = compile_scene(boxes, wide=wide, choose_accelerator=setting.overrides.accelerator)
            assert compiled.arrays["triangle_vertices"][1].nbytes == 24 * 36
            assert "triangle_nodes" in compiled.arrays, setting.value


def _study(scene: Scene, device: Any) -> tuple[measure.Study, measure.Runner, Render]:
    """A study that knows its reference and has measured nothing."""
    runner = measure.Runner(device.name, 1000.0, lambda step: None)
    strict, _, job = runner.pictures(scene, own(), 16, 5000, 8)
    reference = measure.Reference(strict.mean(axis=0, dtype=np.float64), strict.var(axis=0, ddof=1, dtype=np.float64) / 8, strict)
    return measure.Study(scene, job.device.name, reference, "rendered", measure.metrics.weights(reference.mean)), runner, job


def test_a_clamp_has_a_bias_and_the_files_agree(tmp_path: Path, device: Any) -> None:
    scene = _scene()
    result, runner, job = _study(scene, device)
    clamp = Setting("clamp_indirect", "0.01", lambda s: replace(s, integrator=replace(s.integrator, clamp_indirect=0.01)), unbiased=False)
    measure._one(result, runner, job, clamp, [1, 4])
    measure._slopes(result)
    by_name = {(m.setting.name, m.spp): m for m in result.measurements}
    plain, clamped = by_name[OWN, 4], by_name[clamp.name, 4]
    assert clamped.bias2.differs_from_zero and clamped.bias2.value > 0.0
    assert plain.bias2.value < 0.1 * clamped.bias2.value
    assert clamped.variance.value < plain.variance.value
    assert len(by_name) == 4 and all(m.slope is not None for m in result.measurements)

    for path in write(result, tmp_path):
        assert path.stat().st_size > 0
    rows = list(csv.DictReader((tmp_path / "table.csv").open(encoding="utf-8")))
    told = json.loads((tmp_path / "table.json").read_text(encoding="utf-8"))
    assert [float(row["bias²"]) for row in rows] == [m["bias²"] for m in told["measurements"]]
    assert {c["goal"] for c in told["choices"]} == {"10 s", "relMSE 1e-03"}
    html = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "src=\"data:image/png" in html and "<svg" in html and "http" not in html.replace("http-equiv", "")
    assert all(f"<th>{column}</th>" in html for column in COLUMNS)
    assert (rows[0]["FLIP"] == "") == (importlib.util.find_spec("flip_evaluator") is None)


def test_what_does_not_fit_is_named(device: Any) -> None:
    """No time at all: the scene's own settings are measured, and every other is named among what was left out."""
    result = measure.study(_scene(), reference=None, budget=1e-3, device=device.name, tell=lambda step: None)
    assert [m.setting.factor for m in result.measurements] == [OWN]
    names = [s.name for s in settings(_scene(), float(result.reference.mean.mean()))]
    assert [text.partition(":")[0] for text in result.left_out] == names
    assert all(choice.measurement is result.measurements[0] for choice in choices(result))
