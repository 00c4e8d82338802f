"""The benchmark at its smallest: that it works, not how fast anything is."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

BENCHMARK = Path(__file__).resolve().parents[2] / "tools" / "benchmark.py"


def test_the_quick_benchmark_tells_every_figure(device: Any, tmp_path: Path) -> None:
    path = tmp_path / "out.json"
    done = subprocess.run([sys.executable, str(BENCHMARK), "--quick", "--device", device.name, "--json", str(path)], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stderr
    told = json.loads(path.read_text(encoding="utf-8"))
    assert told["device"] == device.name.strip() and {"lumiere", "python", "numpy", "pyopencl"} <= set(told["versions"])
    figures = [*told["start"].values(), *(value for value in told["preparation"].values() if isinstance(value, dict))]
    for part in (told["cornell"], told["spheres"]):
        assert set(part["rays a second"]) == {"nearest", "shadow"} and part["mean"] > 0.0
        figures += [part["samples a second"], *part["rays a second"].values()]
    assert len(figures) == 3 + 4 + 2 * 3
    for figure in figures:
        assert 0.0 < figure["min"] <= figure["median"] <= figure["max"]
    assert set(told["start"]) == {"import", "cold start", "warm start"}
    assert told["preparation"]["triangles"] == 3 * 80 + 2
    assert sum(line.startswith("| ") and "median" not in line for line in done.stdout.splitlines()) == len(figures)
