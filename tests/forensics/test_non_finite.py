"""Samples that are not finite: counted once each, said where, and replayed by the command that the render prints."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

import pytest

from lumiere.cli.main import main


def test_the_command_to_replay_is_printed_and_works(device: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A lamp whose radiance, added to itself by a mirror behind it, overflows single precision."""
    scene = tmp_path / "bright.json"
    scene.write_text(json.dumps({"scene": {
        "film": {"width": 2, "height": 2}, "sampler": {"spp": 3}, "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]},
        "geometry": [{"type": "rectangle", "emission": 3e38, "emission_sides": "both", "material": {"type": "mirror"},
                      "transform": [{"scale": 9}, {"translate": [0, 0, z]}]} for z in (0, 9)]}}), encoding="utf-8")
    record = tmp_path / "record.json"
    assert main(["render", str(scene), "-o", str(tmp_path / "a.exr"), "--record", str(record), "--device", device.name, "--max-depth", "3"]) == 0
    told = capsys.readouterr().err
    found = json.loads(record.read_text(encoding="utf-8"))["non_finite"]
    assert found["count"] == 12 and len(found["samples"]) == 12
    assert "12 samples were not finite" in told
    command = shlex.split(told.partition("to see what happened there: lumiere ")[2].splitlines()[0])
    assert main(command) == 0
    assert "NOT FINITE" in capsys.readouterr().out
