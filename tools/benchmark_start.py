"""Import, cold starts and warm starts, for tools/benchmark.py."""

from __future__ import annotations

import compileall
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmark_figure import figure
from benchmark_scene import CORNELL

ROOT = CORNELL.parent.parent

CACHES = ("LUMIERE_CACHE", "POCL_CACHE_DIR", "XDG_CACHE_HOME", "CUDA_CACHE_PATH", "NEO_CACHE_DIR")
"""Where Lumière, pyopencl and drivers keep programs."""


def timed(action: Callable[[], Any]) -> float:
    """Seconds that ``action`` takes."""
    begin = time.perf_counter()
    action()
    return time.perf_counter() - begin


def import_seconds() -> float:
    """Seconds of `import lumiere` in a fresh interpreter."""
    code = "import time; begin = time.perf_counter(); import lumiere; print(time.perf_counter() - begin)"
    return float(subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True).stdout)


def start_seconds(caches: Path, device: str | None, options: tuple[str, ...]) -> float:
    """Seconds of the whole command on the Cornell box with 1 spp, its caches in ``caches``."""
    environment = os.environ | {name: str(caches / name) for name in CACHES}
    for name in CACHES:
        (caches / name).mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "lumiere", "render", str(CORNELL), "--spp", "1", "-o", str(caches / "out.png"), *options,
               *(("--device", device) if device else ())]
    return timed(lambda: subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, check=True))


def starts(runs: int, device: str | None, folder: Path, options: tuple[str, ...]) -> dict[str, Any]:
    """Import, cold starts (each with empty caches of its own) and warm starts (all with the last one's), of a program whose Python is compiled, as pip
    leaves it.
    """
    compileall.compile_dir(ROOT / "lumiere", quiet=2)
    cold = [start_seconds(folder / f"cold-{i}", device, options) for i in range(runs)]
    warm = [start_seconds(folder / f"cold-{runs - 1}", device, options) for _ in range(runs)]
    return {"import": figure([import_seconds() for _ in range(runs)], "s"), "cold start": figure(cold, "s"), "warm start": figure(warm, "s")}
