"""The comparison of accelerators at its smallest: that it works, not how fast anything is."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from lumiere.accel import names

TOOL = Path(__file__).resolve().parents[2] / "tools" / "accelerators.py"


def test_every_layout_that_the_device_takes_has_its_figures(device: Any, tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    done = subprocess.run([sys.executable, str(TOOL), "tiny", "--device", device.name, "--width", "16", "--height", "16", "--spp", "1", "--repeats", "1",
                           "--json", str(out)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = {row["layout"]: row for row in json.loads(out.read_text(encoding="utf-8"))["layouts"]}
    assert {"bvh2", "bvh2_spatial"} <= set(rows) <= set(names())
    for name, row in rows.items():
        assert row["camera"]["rays"] == 16 * 16 and row["camera"]["rays a second"] > 0.0
        assert row["references a triangle"] >= 1.0 and row["cost"] > 1.0
        assert row["bounce"]["rays"] == rows["bvh2"]["bounce"]["rays"] > 0
        assert f"\n| {name} | " in done.stdout
