"""Measures Lumière: its start, a million triangles, rays and samples a second, noise; with --peers beside other renderers and Embree.

    python tools/benchmark.py [--device D] [--json F] [--peers] [--peer-python P ...] [--parts PART ...] [--scenes SCENE ...] [--layouts] [--quick]

Every figure is the median of five runs, with the least and the most. Renderers take turns, so that a machine that slows down slows all. Scenes are
rendered with at most 7 scattering events and no roulette; peers (tools/benchmark_peer.py) render the same, at the same resolution, with light sampling,
without denoiser or adaptive sampling, on as many threads. How far their pictures are from ours stands beside them, to show that the scenes are the same.
Mitsuba on a CPU needs DRJIT_LIBLLVM_PATH, the file of an LLVM library (19 works; 15 crashes in it). How rays are measured: tools/benchmark_rays.py; noise:
tools/sampler_error.py; what is aimed at: tools/benchmark_bars.py.

It takes minutes. --parts and --scenes measure less at a time; records of the same device made with --json are put together by --merge.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import benchmark_bars  # noqa: E402
import benchmark_rays  # noqa: E402
from benchmark_figure import tell  # noqa: E402
from benchmark_peer import RENDERERS, interpreter  # noqa: E402
from benchmark_render import MAX_DEPTH, benchmark_scene, preparation, speed  # noqa: E402
from benchmark_scene import SCENES, write  # noqa: E402
from benchmark_start import starts  # noqa: E402

import lumiere  # noqa: E402

PARTS = ("start", "preparation", "rays", "speed", "error")


@dataclass(frozen=True)
class Effort:
    """How much is measured: runs, scenes by part, pictures' sizes, seconds that a timed render should take, samples a pixel and size for noise."""

    runs: int
    prepared: str
    rays: tuple[str, ...]
    rendered: tuple[str, ...]
    noisy: tuple[str, ...]
    ray_size: int
    sizes: dict[str, tuple[int, int]]
    seconds: float
    spp: tuple[int, ...] = (16, 64)
    noise_size: int = 64
    start_options: tuple[str, ...] = ()


CPU = Effort(5, "million", ("million", "20k", "cornell"), ("cornell", "million"), ("cornell", "million"), 1024,
             {"cornell": (512, 512), "": (480, 270)}, 2.0)
GPU = replace(CPU, rays=("million", "20k", "cornell", "320"), rendered=("cornell", "million", "320"), ray_size=2896, sizes={"": (1920, 1080)})
QUICK = Effort(1, "tiny", ("tiny",), ("cornell", "tiny"), ("cornell",), 16, {"": (16, 16)}, 0.01, (4,), 8, ("--width", "16", "--height", "16"))


def machine() -> dict[str, Any]:
    """The computer and the versions of what runs on it."""
    model = next((line.partition(":")[2].strip() for line in _cpu_lines() if line.startswith("model name")), platform.processor())
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    versions = {"lumiere": lumiere.__version__, "python": platform.python_version()}
    versions |= {name: version(name) for name in ("numpy", "pyopencl", "trimesh")}
    return {"system": platform.platform(), "processor": model, "cores": cores, "versions": versions}


def _cpu_lines() -> list[str]:
    path = Path("/proc/cpuinfo")
    return path.read_text(encoding="utf-8").splitlines() if path.is_file() else []


def noise(path: Path, effort: Effort, device: str | None, pythons: Sequence[str]) -> dict[str, Any]:
    """Relative variance by spp: ours, and where there is Mitsuba its multijitter sampler's."""
    from sampler_error import ours, relative_variance, theirs

    told: dict[str, Any] = {}
    python = interpreter(RENDERERS[0], pythons)
    for spp in effort.spp:
        scene = benchmark_scene(path, (effort.noise_size, effort.noise_size), spp)
        row = {"ours": relative_variance(ours(scene, device))[0]}
        if python is not None:
            row["Mitsuba multijitter"] = relative_variance(theirs(scene, python, "multijitter"))[0]
            row["ours by it"] = row["ours"] / row["Mitsuba multijitter"]
        told[str(spp)] = row
    return told


def measure(arguments: argparse.Namespace) -> dict[str, Any]:
    """All figures that were asked for."""
    from lumiere.device.select import choose
    from lumiere.wavefront.policy import is_gpu

    chosen = choose(arguments.device)
    gpu = is_gpu(chosen)
    effort = QUICK if arguments.quick else GPU if gpu else CPU
    effort = replace(effort, runs=arguments.runs or effort.runs)
    pythons = arguments.peer_python if arguments.peers else []
    driver = f"{chosen.platform.name} {chosen.driver_version}"
    told: dict[str, Any] = {"format": "lumiere benchmark 2", "quick": arguments.quick, **machine(), "device": chosen.name.strip(), "driver": driver,
                            "device kind": benchmark_bars.device_kind(gpu, driver)}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def scenes(part: str, standard: tuple[str, ...]) -> Iterator[tuple[str, Path]]:
            for scene in (arguments.scenes or standard) if part in arguments.parts else ():
                tell(f"{part}: {scene}")
                yield scene, write(scene, folder)

        if "start" in arguments.parts:
            tell("start")
            told["start"] = starts(effort.runs, arguments.device, folder, effort.start_options)
        if "preparation" in arguments.parts:
            tell("preparation")
            told["preparation"] = preparation(write(effort.prepared, folder), effort.runs, arguments.device)
        embree = benchmark_rays.embree(pythons, folder) if pythons and "rays" in arguments.parts else None
        told["rays"] = {scene: benchmark_rays.measure(path, chosen, effort.ray_size, effort.runs, arguments.layouts, arguments.layouts and not gpu,
                                                      embree, arguments.layouts, folder) for scene, path in scenes("rays", effort.rays)}
        told["speed"] = {scene: speed(path, effort.sizes.get(scene, effort.sizes[""]), effort.runs, effort.seconds, arguments.device, pythons,
                                      folder / f"peers-{scene}") for scene, path in scenes("speed", effort.rendered)}
        told["error"] = {scene: noise(path, effort, arguments.device, pythons) for scene, path in scenes("error", effort.noisy)}
    return told


def merged(paths: list[Path]) -> dict[str, Any]:
    """Records of one device, put together: a later one's figures stand in place of an earlier one's."""
    records = [json.loads(path.read_text(encoding="utf-8")) for path in paths]
    told = records[0]
    for record in records[1:]:
        if (record["device"], record["driver"]) != (told["device"], told["driver"]):
            raise SystemExit(f"found records of {told['device']} ({told['driver']}) and {record['device']} ({record['driver']}), expected one device")
        told |= {part: record[part] for part in ("start", "preparation") if part in record}
        for part in ("rays", "speed", "error"):
            told[part] |= record[part]
    return told


def rows(told: dict[str, Any]) -> list[tuple[str, dict[str, Any], float]]:
    """Name, figure and the factor that gives the unit in the name."""
    found = [(f"{name}, s", value, 1.0) for name, value in told.get("start", {}).items()]
    if "preparation" in told:
        triangles = f"{told['preparation']['triangles']:,} triangles"
        found += [(f"{triangles}: {name}, s", value, 1.0) for name, value in told["preparation"].items() if isinstance(value, dict)]
    for scene, part in told["speed"].items():
        found.append((f"{scene}: Msamples/s", part["samples a second"], 1e-6))
        found += [(f"{scene}: {name}, Msamples/s", peer["samples a second"], 1e-6) for name, peer in part["peers"].items()]
        found += [(f"{scene}: {kind} rays of a render, Mrays/s", value, 1e-6) for kind, value in part["rays a second"].items()]
    return found


def report(told: dict[str, Any]) -> str:
    """The figures as Markdown."""
    lines = [f"Lumière {told['versions']['lumiere']} on {told['device']} ({told['driver']}); {told['processor']}, {told['cores']} cores"]
    if found := rows(told):
        lines += ["", "| | median | least | most |", "|---|---|---|---|"]
        lines += [f"| {name} | {scale * value['median']:.4g} | {scale * value['min']:.4g} | {scale * value['max']:.4g} |" for name, value, scale in found]
    for scene, part in told["speed"].items():
        lines.append(f"\n{scene}: {part['width']} × {part['height']}, {part['spp']} spp, at most {MAX_DEPTH} scattering events, no roulette; "
                     f"mean {part['mean']:.5g}")
        lines += [f"* {peer['ours by it']:.3g} × {name} ({peer['spp']} spp), mean {peer['mean']:.5g}, blocks differ by {100.0 * peer['blocks differ by']:.2g} %"
                  for name, peer in part["peers"].items()]
    if told["rays"]:
        lines += ["", benchmark_rays.table(told["rays"])]
    if told["error"]:
        lines += ["", "| scene | spp | relative variance | Mitsuba multijitter | ours by it |", "|---|---|---|---|---|"]
        for scene, part in told["error"].items():
            for spp, row in part.items():
                theirs = f"{row['Mitsuba multijitter']:.4g} | {row['ours by it']:.3g}" if "ours by it" in row else " | "
                lines.append(f"| {scene} | {spp} | {row['ours']:.4g} | {theirs} |")
    return "\n".join([*lines, "", benchmark_bars.table(told)])


def main() -> None:
    parser = argparse.ArgumentParser(description="Measure Lumière's speed.")
    parser.add_argument("--device", help="number or part of a name from `lumiere devices` (default: the best)")
    parser.add_argument("--quick", action="store_true", help="tiny sizes, to see that it works; the figures mean nothing")
    parser.add_argument("--json", type=Path, help="write all figures to this file")
    parser.add_argument("--peers", action="store_true", help="also measure Mitsuba, Cycles, LuxCore and Embree, in turn with Lumière")
    parser.add_argument("--peer-python", nargs="+", default=[sys.executable], help="interpreters that have the peers (default: this one)")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS, help="what to measure (default: all)")
    parser.add_argument("--scenes", nargs="+", choices=list(SCENES), help="for rays, speed and noise (default: each part's own)")
    parser.add_argument("--layouts", action="store_true", help="rays also by every other layout, and on a CPU by triangle tests that are not watertight")
    parser.add_argument("--runs", type=int, help="of which each figure is the median (default: 5)")
    parser.add_argument("--merge", type=Path, nargs="+", help="measure nothing: put these records together")
    arguments = parser.parse_args()
    told = merged(arguments.merge) if arguments.merge else measure(arguments)
    print(report(told))
    if arguments.json:
        arguments.json.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
