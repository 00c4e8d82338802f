"""The benchmark at its smallest: that it works, not how fast anything is."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

TOOLS = Path(__file__).resolve().parents[2] / "tools"


def quick(device: Any, path: Path, *options: str) -> tuple[dict[str, Any], str]:
    """The record and the text of a quick benchmark."""
    done = subprocess.run([sys.executable, str(TOOLS / "benchmark.py"), "--quick", "--device", device.name, "--json", str(path), *options],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(path.read_text(encoding="utf-8")), done.stdout


def test_the_quick_benchmark_tells_every_figure(device: Any, tmp_path: Path) -> None:
    told, text = quick(device, tmp_path / "out.json")
    assert told["device"] == device.name.strip() and {"lumiere", "python", "numpy", "pyopencl"} <= set(told["versions"])
    figures = [*told["start"].values(), *(value for value in told["preparation"].values() if isinstance(value, dict))]
    for part in told["speed"].values():
        assert set(part["rays a second"]) == {"nearest", "shadow"} and part["mean"] > 0.0
        figures += [part["samples a second"], *part["rays a second"].values()]
    assert len(figures) == 3 + 4 + 2 * 3
    rays = told["rays"]["tiny"]["kinds"]
    assert rays["primary"]["rays"] == 16 * 16 and 0 < rays["bounce"]["rays"] == rays["any-hit"]["rays"] < 16 * 16
    of_rays = [rate for kind in rays.values() for rate in kind["rays a second"].values()]
    assert len(of_rays) == 3
    for figure in figures + of_rays:
        assert 0.0 < figure["min"] <= figure["median"] <= figure["max"]
    assert set(told["start"]) == {"import", "cold start", "warm start"}
    assert told["preparation"]["triangles"] == 3 * 80 + 2
    assert 0.0 < told["error"]["cornell"]["4"]["ours"] < 1.0
    assert all(f"\n| {name}" in text for name in ("cornell: Msamples/s", "tiny | any-hit", "cornell | 4", "cold first pixel"))


def test_every_layout_and_the_fast_test_meet_the_same(device: Any, tmp_path: Path) -> None:
    told, _ = quick(device, tmp_path / "out.json", "--parts", "rays", "--layouts")
    assert all(0.2 < fill < 1.0 for fill in told["rays"]["tiny"]["node fill"].values())  # of 242 triangles' last node not all places
    for kind in told["rays"]["tiny"]["kinds"].values():
        assert len(kind["agree"]) >= 2
        assert all(share > 0.99 for share in kind["agree"].values()), kind["agree"]


def test_records_of_parts_are_put_together(device: Any, tmp_path: Path) -> None:
    quick(device, tmp_path / "a.json", "--parts", "rays")
    quick(device, tmp_path / "b.json", "--parts", "error")
    told, text = quick(device, tmp_path / "c.json", "--merge", str(tmp_path / "a.json"), str(tmp_path / "b.json"))
    assert told["rays"] and told["error"] and "tiny | primary" in text


def test_what_peers_get_is_the_scene(tmp_path: Path) -> None:
    sys.path.insert(0, str(TOOLS))
    try:
        from benchmark_peer import export, read
        from benchmark_render import benchmark_scene
        from benchmark_scene import write
    finally:
        sys.path.remove(str(TOOLS))
    export(benchmark_scene(write("tiny", tmp_path), (32, 18), 4), tmp_path / "out")
    told = read(tmp_path / "out")
    [mesh] = told.meshes
    assert told.size == (32, 18) and told.values["sky"] == [1.0, 1.0, 1.0] and told.values["max_depth"] == 7
    assert mesh.faces.shape == (3 * 80 + 2, 3) and len(mesh.vertices) == 3 * 42 + 4 and mesh.albedo == [0.7, 0.7, 0.7]
    ply = mesh.write_ply(tmp_path / "out.ply")
    import trimesh

    loaded = trimesh.load(ply, process=False)
    assert np.array_equal(loaded.vertices, mesh.vertices) and np.array_equal(loaded.faces, mesh.faces)


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_program_that_calls_embree_compiles(tmp_path: Path) -> None:
    subprocess.run(["cc", "-O1", "-Wall", "-Wextra", "-Werror", "-pthread", str(TOOLS / "benchmark_embree.c"), "-o", str(tmp_path / "out"), "-ldl"],
                   check=True)
