"""A profile on a device: a row for each stage, counts that agree with the rays traced, and files that parse."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from html import escape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from lumiere import rendering
from lumiere.accel import layouts, preferring
from lumiere.cli.main import main
from lumiere.overrides import Overrides
from lumiere.profile.measure import REPEATS, Profile
from lumiere.profile.observe import Census
from lumiere.profile.page import page
from lumiere.profile.report import compare_text, findings, summary_json, table_text, trace_json
from lumiere.profile.summary import summary
from lumiere.rendering import Render
from lumiere.scene.load import load
from lumiere.wavefront.source import TRACING
from tests.profile.conftest import SCENE

STAGES = ["generate", "extend", "escape", "shade[lambert]", "connect", "accumulate"]
SAMPLES = 16 * 12 * 8


def test_every_stage_has_a_row(profile: Profile) -> None:
    told = summary(profile)
    assert [row["stage"] for row in told["stages"]] == STAGES
    for row in told["stages"]:
        assert row["launches"] == sum(launch.stage == row["stage"] for launch in profile.run.launches) > 0
        assert row["seconds"] > 0.0 and row["items"] > 0
        assert row["bytes"] > 0 and (row["state_read_per_item"] + row["state_written_per_item"] > 0) == (row["stage"] != "accumulate")
        assert (row["rays_per_second"] is not None) == (row["stage"] in ("extend", "connect"))
    assert sum(row["share"] for row in told["stages"]) == pytest.approx(1.0)
    lines = table_text(told).splitlines()
    for stage in STAGES:
        assert any(line.startswith(f"{stage} ") and " % " in line for line in lines)


def test_times_add_up_to_the_span_of_the_events(profile: Profile) -> None:
    seconds = summary(profile)["seconds"]
    launches = profile.run.launches
    assert launches[0].start == 0.0 and all(launch.seconds >= 0.0 for launch in launches)
    span = max(launch.end for launch in launches)
    # Kernels of an in-order queue do not overlap; clocks of 1 µs may make it look so.
    assert seconds["kernels"] + seconds["idle"] == pytest.approx(span, abs=1e-6 * len(launches))
    assert len(profile.profiled) == len(profile.plain) == REPEATS and min(profile.profiled + profile.plain) > 0.0


@pytest.mark.parametrize("compacted", [False, True])
def test_items_are_the_rays_and_paths(device: Any, compacted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    own = rendering.policy_for
    monkeypatch.setattr(rendering, "policy_for", lambda *given: replace(own(*given), compacted=compacted, slots=256, batch=16 * 12 * 3))
    job = Render(load(SCENE), device.name)
    job.wavefront.count_visits()
    census = Census(job.wavefront)
    job.wavefront.observer = census
    job.run()
    total = {stage: sum(count.items for (_, _, name), count in census.counts.items() if name == stage) for stage in STAGES}
    assert total["extend"] == job.wavefront.rays.nearest == sum(census.paths.values())
    assert total["connect"] == job.wavefront.rays.shadow > 0
    assert total["generate"] == total["accumulate"] == SAMPLES
    assert total["shade[lambert]"] + total["escape"] == total["extend"]
    assert {batch for batch, _ in census.paths} == {0, 1, 2}
    # What one stage gives is what the next ones find.
    for stage in ("extend", "escape", "shade[lambert]", "connect"):
        assert total[stage] == sum(count.out.get(stage, 0) for count in census.counts.values())
    assert not any(count.out for (_, _, name), count in census.counts.items() if name in ("escape", "connect", "accumulate"))
    for (_, _, name), count in census.counts.items():
        assert 0 <= count.items <= count.slots or name == "accumulate"
        assert (count.visits is not None) == (name in TRACING)
        if name in TRACING:
            assert count.visits[:, 0].sum() == count.items


def test_the_json_is_whole(profile: Profile) -> None:
    told = json.loads(summary_json(summary(profile)))
    assert told["format"] == "lumiere profile 2" and told["device"] == profile.render.device.name.strip()
    assert (told["width"], told["height"], told["spp"], told["samples"]) == (16, 12, 8, SAMPLES)
    assert set(told["seconds"]) == {"load", "accelerator", "compile", "wall", "kernels", "idle", "before_and_after", "host_thread"}
    assert told["copy_bandwidth"] > 0.0 and told["samples_per_second"] > 0.0
    assert sum(r["items"].get("generate", 0) for r in told["rounds"]) == SAMPLES
    assert sum(r["paths"] for r in told["rounds"]) == next(row["items"] for row in told["stages"] if row["stage"] == "extend")
    for row in told["stages"]:
        assert sum(r["seconds"].get(row["stage"], 0.0) for r in told["rounds"]) == pytest.approx(row["seconds"])


def test_bounces_are_the_rays_by_depth(profile: Profile) -> None:
    """Camera rays first, no more rays than the bounce before had, none beyond the depth limit; times that add up to those of the stages."""
    told = summary(profile)
    rows = {row["stage"]: row for row in told["stages"]}
    bounces = told["bounces"]
    assert [row["bounce"] for row in bounces] == list(range(5))  # max_depth 4
    assert bounces[0]["extend"]["rays"] == SAMPLES
    counts = [row["extend"]["rays"] for row in bounces]
    assert counts == sorted(counts, reverse=True) and all(row["connect"]["rays"] <= row["extend"]["rays"] for row in bounces)
    assert bounces[-1]["connect"]["rays"] == 0
    for stage in TRACING:
        assert sum(row[stage]["rays"] for row in bounces) == rows[stage]["items"]
        # A plane and a sphere, each in a list of its own; a shadow ray need not ask both.
        assert all(row[stage]["nodes_per_ray"] in (0.0, None) for row in bounces)
        assert all(row[stage]["primitives_per_ray"] is None or row[stage]["primitives_per_ray"] <= 2.0 for row in bounces)
    assert all(row["extend"]["primitives_per_ray"] == 2.0 for row in bounces)
    for stage in STAGES[:-1]:
        assert 0.0 < sum(row["seconds"].get(stage, 0.0) for row in bounces) <= rows[stage]["seconds"] * (1.0 + 1e-9)


@pytest.mark.parametrize("layout", [name for name in layouts() if name != "flat"])
def test_visits_are_those_of_the_tree(device: Any, layout: str) -> None:
    """Rays straight through 64 small squares a metre apart meet the two triangles of one; beside them, nothing but the root."""
    corners = [[x + i, y + j, 0] for x in range(8) for y in range(8) for i, j in ((0, 0), (0.5, 0), (0.5, 0.5), (0, 0.5))]
    faces = [[4 * i + a for a in face] for i in range(64) for face in ((0, 1, 2), (0, 2, 3))]

    def visits(x: float) -> Any:
        scene = load({"scene": {
            "camera": {"type": "orthographic", "position": [x, 0.2, 5], "look_at": [x, 0.2, 0], "height": 0.01}, "integrator": {"max_depth": 0},
            "film": {"width": 4, "height": 4}, "sampler": {"spp": 4}, "geometry": [{"type": "mesh", "vertices": corners, "faces": faces}],
            "lights": [{"type": "environment", "radiance": 1.0}]}})
        job = Render(scene, device.name, overrides=Overrides(accelerator=preferring(layout)))
        job.wavefront.count_visits()
        job.run()
        return job.wavefront.visits("extend")

    for x, primitives in ((3.2, (2, 16)), (-5.0, (0, 0))):
        counts = visits(x)
        assert counts[0, 0] == 64 and not counts[1:].any()
        _, nodes, tested = counts[0] // 64
        assert primitives[0] <= tested <= primitives[1]
        assert (nodes == 1 and tested == 0) if x < 0 else 1 <= nodes <= 8


def test_the_trace_has_every_launch(profile: Profile) -> None:
    events = json.loads(trace_json(profile))["traceEvents"]
    kernels = [event for event in events if event["ph"] == "X"]
    assert len(kernels) == len(profile.run.launches)
    assert {event["name"] for event in kernels} == set(STAGES)
    assert all(event["dur"] >= 0.0 and event["args"]["items"] >= 0 for event in kernels)
    assert [event["ts"] for event in kernels] == sorted(event["ts"] for event in kernels)
    assert sum(event["ph"] == "C" for event in events) == sum(event["name"] == "generate" for event in kernels)


class _Tags(HTMLParser):
    """Sees that what is opened is closed."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        if tag != "meta":
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_the_page_stands_alone(profile: Profile) -> None:
    text = page(profile, summary(profile))
    tags = _Tags()
    tags.feed(text)
    assert tags.open == []
    assert not re.search(r"https?:|src=|<script|<link", text)
    charts = [ElementTree.fromstring(svg) for svg in re.findall(r"<svg.*?</svg>", text, re.DOTALL)]
    assert len(charts) == 5
    bars = [element.text or "" for element in charts[2].iter("title")]
    close = [launch for launch in profile.run.launches if launch.batch == 0 and launch.round < 16 and launch.stage != "accumulate"]
    assert len(bars) == len(close)
    assert bars[0].startswith("generate, batch 0, round 0: ")
    assert charts[3].attrib["aria-label"] == "rays and time by bounce"
    assert sum("shadow rays" in (element.text or "") for element in charts[3].iter("title")) == len(summary(profile)["bounces"])
    assert charts[4].attrib["aria-label"] == "paths alive by round"
    assert sum("alive" in (element.text or "") for element in charts[4].iter("title")) > 0
    for line in findings(summary(profile)):
        assert escape(line) in text


def test_comparing_shows_ratios(profile: Profile) -> None:
    told = json.loads(summary_json(summary(profile)))
    slower = json.loads(json.dumps(told))
    for row in slower["stages"]:
        if row["stage"] == "extend":
            row["seconds"] *= 2.0
            row["rays_per_second"] /= 2.0
    lines = {line.split("  ")[0]: line.split()[-1] for line in compare_text(told, slower).splitlines() if line}
    assert lines["extend, ns/sample"] == "2.000" and lines["extend, Mrays/s"] == "0.500" and lines["connect, ns/sample"] == "1.000"


def test_the_command_writes_what_it_is_asked_for(device: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(SCENE), encoding="utf-8")
    names = {kind: str(tmp_path / f"out.{kind}") for kind in ("json", "html", "trace")}
    arguments = ["profile", str(scene), "--spp", "1", "--width", "8", "--height", "8", "--device", device.name]
    assert main([*arguments, *(word for kind, name in names.items() for word in (f"--{kind}", name))]) == 0
    assert "population by round" in capsys.readouterr().out
    assert json.loads(Path(names["json"]).read_text(encoding="utf-8"))["samples"] == 64
    assert "</html>" in Path(names["html"]).read_text(encoding="utf-8")
    assert json.loads(Path(names["trace"]).read_text(encoding="utf-8"))["traceEvents"]
    assert main(["profile", "--compare", names["json"], names["json"]]) == 0
    assert "1.000" in capsys.readouterr().out
