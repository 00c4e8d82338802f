"""Measures Lumière: its start, a million triangles, and samples and rays a second on two scenes; with --peers beside other renderers.

    python tools/benchmark.py [--device D] [--json F] [--peers] [--quick]

Every figure is the median of several runs, with the least and the most. Renderers take turns, so that a machine that slows down slows all.
Both scenes are rendered with at most 7 scattering events and no roulette. Mitsuba needs `pip install mitsuba` and, on a CPU, DRJIT_LIBLLVM_PATH,
the file of an LLVM library (19 works; 15 crashes in it); --peer-python names another interpreter that has Mitsuba. The means of the pictures stand
beside each other to show that the scenes are the same.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from benchmark_mitsuba import Peer, export  # noqa: E402
from benchmark_scene import Spheres, write_spheres  # noqa: E402

import lumiere  # noqa: E402

CORNELL = ROOT / "scenes" / "cornell.json"

MAX_DEPTH = 7

CACHES = ("LUMIERE_CACHE", "POCL_CACHE_DIR", "XDG_CACHE_HOME", "CUDA_CACHE_PATH", "NEO_CACHE_DIR")
"""Where Lumière, pyopencl and drivers keep programs."""


@dataclass(frozen=True)
class Effort:
    """How much is measured: numbers of runs, triangles, pictures' sizes, and seconds that a timed render should take."""

    starts: int
    cold_starts: int
    loads: int
    renders: int
    spheres: int
    faces: int
    cornell: tuple[int, int]
    million: tuple[int, int]
    seconds: float
    start_options: tuple[str, ...] = ()


CPU = Effort(5, 3, 3, 5, 50, 20480, (512, 512), (480, 270), 2.0)
GPU = replace(CPU, cornell=(1920, 1080), million=(1920, 1080))
QUICK = Effort(1, 1, 1, 2, 3, 80, (16, 16), (16, 16), 0.01, ("--width", "16", "--height", "16"))


def figure(values: list[float], unit: str) -> dict[str, Any]:
    """Median, least and most of ``values``."""
    return {"median": median(values), "min": min(values), "max": max(values), "values": values, "unit": unit}


def timed(action: Callable[[], Any]) -> float:
    """Seconds that ``action`` takes."""
    begin = time.perf_counter()
    action()
    return time.perf_counter() - begin


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


def starts(effort: Effort, device: str | None, folder: Path) -> dict[str, Any]:
    """Import, cold starts (each with empty caches of its own) and warm starts (all with the last one's)."""
    cold = [start_seconds(folder / f"cold-{i}", device, effort.start_options) for i in range(effort.cold_starts)]
    warm = [start_seconds(folder / f"cold-{effort.cold_starts - 1}", device, effort.start_options) for _ in range(effort.starts)]
    return {"import": figure([import_seconds() for _ in range(effort.starts)], "s"), "cold start": figure(cold, "s"), "warm start": figure(warm, "s")}


def prepare(path: Path, size: tuple[int, int], spp: int, device: str | None) -> Any:
    """A Render of the scene at ``path`` with the benchmark's integrator."""
    from lumiere import api
    from lumiere.rendering import Render

    begin = time.perf_counter()
    scene = api.with_options(api.load(path), {"width": size[0], "height": size[1], "spp": spp, "max_depth": MAX_DEPTH})
    scene = replace(scene, integrator=replace(scene.integrator, russian_roulette_depth=None))
    return Render(scene, device, time.perf_counter() - begin, profiling=True)


def preparation(path: Path, effort: Effort, device: str | None) -> dict[str, Any]:
    """What comes before the first sample: load, accelerator, upload, and programs from the cache."""
    from lumiere.wavefront.memory import DeviceMemory

    times: dict[str, list[float]] = {name: [] for name in ("load", "accelerator", "upload", "upload and programs")}
    for _ in range(effort.loads):
        render = prepare(path, effort.million, 1, device)
        wavefront = render.wavefront
        memory = DeviceMemory(wavefront.context, wavefront.queue)
        begin = time.perf_counter()
        kept = [memory.upload(name, array) for name, (_, array) in wavefront.buffers.arrays.items()]
        wavefront.finish()
        times["upload"].append(time.perf_counter() - begin)
        for buffer in kept:
            buffer.release()
        times["load"].append(render.seconds["load"])
        times["accelerator"].append(render.seconds["accelerator"])
        times["upload and programs"].append(render.seconds["compile"])
    return {name: figure(values, "s") for name, values in times.items()} | {
        "triangles": effort.spheres * effort.faces + 2, "bytes": wavefront.buffers.bytes}


def sized(path: Path, size: tuple[int, int], device: str | None, seconds: float) -> Any:
    """A warm Render whose spp, a power of two, takes about ``seconds``."""
    render = prepare(path, size, 4, device)
    render.run()
    render.restart(0)
    render.run()
    spp = 4
    while spp < 1024 and spp * render.seconds["render"] / 4 < seconds / 1.5:
        spp *= 2
    if spp == 4:
        return render
    render = prepare(path, size, spp, device)
    render.run()
    return render


def speed(path: Path, size: tuple[int, int], effort: Effort, device: str | None, peers: Callable[[Any, Path], list[Peer]],
          folder: Path) -> dict[str, Any]:
    """Samples a second of ours and of the peers, in turn, and rays a second by kind."""
    import pyopencl as cl

    render = sized(path, size, device, effort.seconds)
    others = peers(render.scene, folder)
    wavefront = render.wavefront
    with_events, wavefront.queue = wavefront.queue, cl.CommandQueue(wavefront.context, render.device)
    ours: list[float] = []
    theirs: dict[str, list[float]] = {peer.name: [] for peer in others}
    means: dict[str, float] = {}
    for seed in range(1, effort.renders + 1):
        render.restart(seed)
        wavefront.finish()
        render.run()
        ours.append(render.samples / render.seconds["render"])
        for peer in others:
            taken, means[peer.name] = peer.render(seed)
            theirs[peer.name].append(render.samples / taken)
    for peer in others:
        peer.close()
    mean = float(render.image({}).pixels.mean())
    wavefront.queue = with_events
    rows = {name: {"samples a second": figure(values, "1/s"), "ours by it": median(ours) / median(values), "mean": means[name]}
            for name, values in theirs.items()}
    return {"width": size[0], "height": size[1], "spp": render.scene.sampler.spp, "samples a second": figure(ours, "1/s"), "mean": mean,
            "rays a second": ray_rates(render, effort.renders), "peers": rows}


def ray_rates(render: Any, runs: int) -> dict[str, Any]:
    """Rays a second by kind, from the device's events: nearest hits (extend) and shadow rays (connect)."""
    from lumiere.profile.observe import Times

    wavefront = render.wavefront
    rates: dict[str, list[float]] = {}
    for seed in range(1, runs + 1):
        render.restart(seed)
        before = replace(wavefront.rays)
        times = Times()
        wavefront.observer = times
        render.run()
        wavefront.observer = None
        launches = times.launches()
        for kind, stage, rays in (("nearest", "extend", wavefront.rays.nearest - before.nearest),
                                  ("shadow", "connect", wavefront.rays.shadow - before.shadow)):
            seconds = sum(launch.seconds for launch in launches if launch.stage == stage)
            if seconds > 0.0:
                rates.setdefault(kind, []).append(rays / seconds)
    return {kind: figure(values, "1/s") for kind, values in rates.items()}


def mitsuba(python: str, gpu: bool) -> Callable[[Any, Path], list[Peer]]:
    """Starts Mitsuba on a scene and warms it up; where it cannot be had, says so and gives no peer."""
    if subprocess.run([python, "-c", "import mitsuba"], capture_output=True, check=False).returncode:
        tell(f"left out: Mitsuba, which {python} cannot import; get it with `pip install mitsuba`")
        return lambda scene, folder: []
    variant = "cuda_ad_rgb" if gpu else "llvm_ad_rgb"

    def start(scene: Any, folder: Path) -> list[Peer]:
        folder.mkdir()
        export(scene, folder, variant)
        try:
            peer = Peer(python, folder)
            peer.render(0)  # compiles
            return [peer]
        except RuntimeError as error:
            tell(f"left out: {error}")
            return []

    return start


def tell(step: str) -> None:
    """A line for whoever waits."""
    print(step, file=sys.stderr, flush=True)


def measure(device: str | None, quick: bool, peer_python: str | None) -> dict[str, Any]:
    """All figures."""
    from lumiere.device.select import choose
    from lumiere.wavefront.policy import is_gpu

    chosen = choose(device)
    effort = QUICK if quick else GPU if is_gpu(chosen) else CPU
    peers = mitsuba(peer_python, is_gpu(chosen)) if peer_python else lambda scene, folder: []
    told: dict[str, Any] = {"format": "lumiere benchmark 1", "quick": quick, **machine(), "device": chosen.name.strip(),
                            "driver": f"{chosen.platform.name} {chosen.driver_version}"}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tell("starts")
        told["start"] = starts(effort, device, folder)
        tell("many triangles")
        spheres = write_spheres(folder / "spheres", Spheres(effort.spheres, effort.faces), effort.million)
        told["preparation"] = preparation(spheres, effort, device)
        tell("Cornell box")
        told["cornell"] = speed(CORNELL, effort.cornell, effort, device, peers, folder / "cornell")
        tell("many triangles, rendered")
        told["spheres"] = speed(spheres, effort.million, effort, device, peers, folder / "spheres")
    return told


def rows(told: dict[str, Any]) -> list[tuple[str, dict[str, Any], float]]:
    """Name, figure and the factor that gives the unit in the name."""
    found = [(f"{name}, s", value, 1.0) for name, value in told["start"].items()]
    triangles = f"{told['preparation']['triangles']:,} triangles"
    found += [(f"{triangles}: {name}, s", value, 1.0) for name, value in told["preparation"].items() if isinstance(value, dict)]
    for title, part in (("Cornell box", told["cornell"]), (triangles, told["spheres"])):
        found.append((f"{title}: Msamples/s", part["samples a second"], 1e-6))
        found += [(f"{title}: {name}, Msamples/s", peer["samples a second"], 1e-6) for name, peer in part["peers"].items()]
        found += [(f"{title}: {kind} rays, Mrays/s", value, 1e-6) for kind, value in part["rays a second"].items()]
    return found


def table(told: dict[str, Any]) -> str:
    """The figures as a Markdown table."""
    lines = [f"Lumière {told['versions']['lumiere']} on {told['device']} ({told['driver']}); {told['processor']}, {told['cores']} cores"]
    lines += [f"{title}: {part['width']} × {part['height']}, {part['spp']} spp, at most {MAX_DEPTH} scattering events, no roulette"
              for title, part in (("Cornell box", told["cornell"]), ("triangles", told["spheres"]))]
    lines += ["", "| | median | least | most |", "|---|---|---|---|"]
    lines += [f"| {name} | {scale * value['median']:.4g} | {scale * value['min']:.4g} | {scale * value['max']:.4g} |"
              for name, value, scale in rows(told)]
    for title, part in (("Cornell box", told["cornell"]), ("triangles", told["spheres"])):
        lines += [f"\n{title}: {peer['ours by it']:.2f} × {name}; means of the pictures {part['mean']:.5g} and {peer['mean']:.5g}"
                  for name, peer in part["peers"].items()]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description="Measure Lumière's speed.")
    parser.add_argument("--device", help="number or part of a name from `lumiere devices` (default: the best)")
    parser.add_argument("--quick", action="store_true", help="tiny sizes, to see that it works; the figures mean nothing")
    parser.add_argument("--json", type=Path, help="write all figures to this file")
    parser.add_argument("--peers", action="store_true", help="also measure Mitsuba, in turn with Lumière")
    parser.add_argument("--peer-python", default=sys.executable, help="interpreter that has the peers (default: this one)")
    arguments = parser.parse_args()
    told = measure(arguments.device, arguments.quick, arguments.peer_python if arguments.peers else None)
    print(table(told))
    if arguments.json:
        arguments.json.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
