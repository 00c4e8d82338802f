"""Rays a second: primary, bounce and any-hit rays through the accelerators, beside Embree's single-ray calls on the same rays.

    python tools/benchmark_rays.py [--device D] [--scenes million 20k cornell] [--layouts] [--fast-test] [--embree] [--peer-python P ...] [--json F]

Primary rays go through the pixels' centres of a square picture, in tiles of 8 × 8. From what they meet start the bounce rays, cosine-distributed about
the normal, and the any-hit rays: to points on the lamps, or, where the sky is the light, in directions uniform over the hemisphere. They stay in that order.

Ours are traced by the functions that `extend` and `connect` call, in a kernel that does nothing else (tools/benchmark_trace.cl), built with the
macros, attributes and work-group size of a render on that device; `--layouts` adds every other layout that can hold the triangles, and `--fast-test`
bvh8 with Möller and Trumbore's test in place of the watertight one (tools/fast_test/, not part of the renderer). Times are those of OpenCL events,
after one launch that is not counted. Embree's are traced by tools/benchmark_embree.c, compiled when asked for (`cc -O3 -march=native`) and run as a
process of its own with as many threads as this process may use cores: rtcIntersect1 and rtcOccluded1 ray by ray, since the calls of Embree's Python
bindings run on one thread and build arrays. Its library is that of `pip install embreex` in an interpreter of `--peer-python`. It has no robust flag
and its default build quality, so its test is the fast one; `--embree robust` adds a scene with RTC_SCENE_FLAG_ROBUST.

All take turns, run after run. A ratio is the median over the runs of ours by theirs. `agree`: the share of rays for which ours and Embree's meet
something at the same distance to one in a thousand, or both nothing.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from benchmark_figure import figure, let_rest, tell  # noqa: E402
from benchmark_peer import Peer  # noqa: E402
from benchmark_scene import SCENES, write  # noqa: E402

TILE = 8
KINDS = {"primary": "nearest", "bounce": "nearest", "any-hit": "any"}
ROBUST = 4
FLAT_AT_MOST = 64
"""Triangles that a plain list is measured with."""
NONE = 0xFFFFFFFF


@dataclass(frozen=True)
class Way:
    """One way to trace: triangles in ``accelerator``, or None for what the device gets, with files of ``cl/`` replaced by other texts."""

    name: str
    accelerator: Callable[[], Any] | None = None
    replaced: Mapping[str, str] | None = None


class Tracer:
    """A scene on a device, that traces rays one way. ``seconds``: what its accelerator took to make on the host."""

    def __init__(self, scene: Any, device: Any, context: Any, queue: Any, way: Way) -> None:
        import pyopencl as cl

        from lumiere.accel import choose
        from lumiere.compile.scene import compile_scene
        from lumiere.device.source import assemble
        from lumiere.wavefront.policy import is_gpu, policy_for
        from lumiere.wavefront.source import generated_sources, prelude
        from lumiere.wavefront.state import words_per_path

        self.queue = queue

        def chosen(shape: str, count: int, bounded: bool, wide: bool) -> Any:
            return way.accelerator() if way.accelerator is not None and shape == "triangle" else choose(shape, count, bounded, wide)

        buffers = compile_scene(scene, wide=not is_gpu(device), choose_accelerator=chosen)
        self.layout, self.seconds = buffers.features.shapes["triangle"], buffers.seconds["accelerator"]
        self.vertices = buffers.arrays["triangle_vertices"][1].reshape(-1, 3, 3)
        self.fill = node_fill(buffers.arrays)
        self.bytes = sum(array.nbytes for name, (_, array) in buffers.arrays.items() if name.startswith("triangle_"))
        policy = policy_for(device, 1 << 26, 4 * sum(words_per_path(buffers.features)), 4 * buffers.features.channel_count())
        self.group = policy.work_group
        parameters = ", ".join(f"global const {c_type} *scene_{name}" for name, (c_type, _) in buffers.arrays.items())
        begin = "scene_t scene; " + " ".join(f"scene.{name} = scene_{name};" for name in buffers.arrays)
        above = prelude(buffers, policy) + f"#define SCENE_PARAMETERS {parameters}\n#define SCENE_BEGIN {begin}\n"
        text = (HERE / "benchmark_trace.cl").read_text(encoding="utf-8")
        generated = generated_sources(buffers, policy) | {"trace.cl": text} | (way.replaced or {})
        program = cl.Program(context, assemble("trace.cl", above, generated)).build()
        self.kernels = {how: cl.Kernel(program, f"trace_{how}_hits") for how in ("nearest", "any")}
        self.items = self.kernels["any"].get_work_group_info(cl.kernel_work_group_info.COMPILE_WORK_GROUP_SIZE, device)[0]
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        self.scene = [cl.Buffer(context, flags, hostbuf=array if array.nbytes else np.zeros(1, np.uint32)) for _, array in buffers.arrays.values()]

    def trace(self, rays: Rays) -> float:
        """Seconds of ``rays``; the results are then in their buffers."""
        import pyopencl as cl

        kernel = self.kernels[KINDS[rays.kind]]
        kernel.set_args(rays.buffer, np.uint32(rays.count), np.uint32(rays.stride), rays.distances, rays.primitives, *self.scene)
        event = cl.enqueue_nd_range_kernel(self.queue, kernel, (-(-rays.count // self.group) * self.items,), (self.items,))
        event.wait()
        return 1e-9 * (event.profile.end - event.profile.start)


class Rays:
    """Rays of a kind on a device: (n, 7) float32, origin, direction, farthest distance; and where results go."""

    def __init__(self, kind: str, rays: np.ndarray, context: Any, queue: Any) -> None:
        import pyopencl as cl

        self.kind, self.rays, self.count, self.queue = kind, rays, len(rays), queue
        self.stride = self.count + 16  # arrays a power of two apart share cache sets
        padded = np.zeros((7, self.stride), np.float32)
        padded[:, :self.count] = rays.T
        self.buffer = cl.Buffer(context, cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR, hostbuf=padded)
        self.distances, self.primitives = (cl.Buffer(context, cl.mem_flags.READ_WRITE, 4 * self.count) for _ in range(2))

    def results(self) -> tuple[np.ndarray, np.ndarray]:
        """Distances (n,) float32, or 0 and 1 for any-hit rays; and primitives (n,) uint32."""
        import pyopencl as cl

        distances, primitives = np.zeros(self.count, np.float32), np.zeros(self.count, np.uint32)
        cl.enqueue_copy(self.queue, distances, self.distances)
        cl.enqueue_copy(self.queue, primitives, self.primitives)
        return distances, primitives


def primary(scene: Any, size: int) -> np.ndarray:
    """(size², 7) float32: rays of a pinhole through the centres of ``size`` × ``size`` pixels, a multiple of TILE, tile by tile."""
    half_x, half_y = scene.camera.device_values(size, size)["half_extent"]
    tiles, inside = np.divmod(np.arange(size * size), TILE * TILE)
    tile_y, tile_x = np.divmod(tiles, size // TILE)
    y, x = np.divmod(inside, TILE)
    x, y = (tile_x * TILE + x + 0.5) / size, (tile_y * TILE + y + 0.5) / size
    local = np.stack([(2.0 * x - 1.0) * half_x, (1.0 - 2.0 * y) * half_y, np.full_like(x, -1.0)], axis=1)
    to_world = scene.camera.to_world()
    directions = local @ to_world[:3, :3].T
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return _packed(np.broadcast_to(to_world[:3, 3], directions.shape), directions, np.inf)


def _packed(origins: np.ndarray, directions: np.ndarray, farthest: Any) -> np.ndarray:
    rays = np.zeros((len(directions), 7), np.float32)
    rays[:, :3], rays[:, 3:6], rays[:, 6] = origins, directions, farthest
    return rays


def secondary(scene: Any, rays: np.ndarray, distances: np.ndarray, normals: np.ndarray) -> dict[str, np.ndarray]:
    """Bounce and any-hit rays from where ``rays`` (n, 7) met something: at ``distances`` (n,), on planes with ``normals`` (n, 3), unit."""
    random = np.random.default_rng(7)
    directions = rays[:, 3:6].astype(np.float64)
    normals = normals * -np.sign(np.sum(normals * directions, axis=1, keepdims=True))
    points = rays[:, :3] + directions * distances[:, None].astype(np.float64)
    origins = points + normals * 1e-5 * np.maximum(1.0, np.abs(points).max(axis=1, keepdims=True))
    sphere = random.normal(size=points.shape)
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    cosine = normals + sphere * 0.9999
    cosine /= np.linalg.norm(cosine, axis=1, keepdims=True)
    lamps = [lamp for lamp in scene.geometry if lamp.emission is not None]
    if lamps:
        lamp = np.concatenate([part.records["vertices"] for part in lamps[0].lower()])
        lamp = lamp[random.integers(len(lamp), size=len(points))]
        to_light = np.einsum("nv,nva->na", random.dirichlet([1, 1, 1], len(points)), lamp) - origins
        length = np.linalg.norm(to_light, axis=1, keepdims=True)
        any_hit = _packed(origins, to_light / length, length[:, 0] * 0.999)
    else:
        any_hit = _packed(origins, sphere * np.where(np.sum(sphere * normals, axis=1, keepdims=True) < 0.0, -1.0, 1.0), np.inf)
    return {"bounce": _packed(origins, cosine, np.inf), "any-hit": any_hit}


def all_rays(scene: Any, tracer: Tracer, size: int, context: Any, queue: Any) -> list[Rays]:
    """Rays of every kind."""
    first = Rays("primary", primary(scene, size), context, queue)
    tracer.trace(first)
    distances, primitives = first.results()
    met = primitives != NONE
    corners = tracer.vertices[primitives[met]].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return [first, *(Rays(kind, rays, context, queue) for kind, rays in secondary(scene, first.rays[met], distances[met], normals).items())]


class Embree(Peer):
    """Embree on the same triangles. ``name`` has its version; ``seconds``: what its build took."""

    def __init__(self, program: Path, library: Path, folder: Path, robust: bool) -> None:
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
        super().__init__([str(program), str(library), str(folder), str(cores), str(ROBUST if robust else 0)])
        self.folder = folder
        self.name, seconds = self.name.split("\t")
        self.seconds = float(seconds)

    def trace(self, rays: Rays) -> float:
        """Seconds of ``rays``, which ``export`` has written."""
        return float(self.ask(f"{rays.kind} {KINDS[rays.kind]}")[0])

    def distances(self, rays: Rays) -> np.ndarray:
        """(n,) float32 of the last time; 0 and 1 for any-hit rays."""
        return np.fromfile(self.folder / f"{rays.kind}.out", np.float32)


def embree(pythons: Sequence[str], folder: Path) -> Callable[[np.ndarray, list[Rays], Path, bool], Embree] | None:
    """Starts Embree on triangles and rays; None, and a word about it, where it or a C compiler cannot be had."""
    code = ("import glob, importlib.util as u; s = u.find_spec('embreex'); "
            "print(*(glob.glob(s.submodule_search_locations[0] + '.libs/libembree4*') if s else []))")
    found = (subprocess.run([python, "-c", code], capture_output=True, text=True, check=False).stdout.strip() for python in pythons)
    library = next((path for path in found if path), None)
    compiler = shutil.which("cc")
    if not library or not compiler:
        tell("left out: Embree" + (", for want of a C compiler `cc`" if library else f", which {' or '.join(pythons)} has not got; get it with "
                                                                                     "`pip install embreex`"))
        return None
    program = folder / "benchmark_embree"
    subprocess.run([compiler, "-O3", "-march=native", "-pthread", str(HERE / "benchmark_embree.c"), "-o", str(program), "-ldl"], check=True)

    def start(vertices: np.ndarray, rays: list[Rays], at: Path, robust: bool) -> Embree:
        at.mkdir(exist_ok=True)
        vertices.astype(np.float32).tofile(at / "vertices.f32")
        for some in rays:
            some.rays.tofile(at / f"{some.kind}.rays")
        return Embree(program, Path(library), at, robust)

    return start


def agreement(rays: Rays, ours: np.ndarray, theirs: np.ndarray) -> float:
    """The share of rays that meet the same."""
    if KINDS[rays.kind] == "any":
        return float(np.mean(ours == theirs))
    both = np.isfinite(ours) & np.isfinite(theirs)
    near = np.zeros(len(ours), bool)
    near[both] = np.abs(ours[both] - theirs[both]) <= 1e-3 * theirs[both]
    return float(np.mean(near | (np.isinf(ours) & np.isinf(theirs))))


def ways(device: Any, count: int, every: bool, fast_test: bool) -> list[Way]:
    """The device's own way; with ``every`` all other layouts that can hold ``count`` triangles; and with ``fast_test`` bvh8 with the fast test."""
    from lumiere.accel import choose
    from lumiere.tradeoff.settings import layouts
    from lumiere.wavefront.policy import is_gpu

    own = choose("triangle", count, True, not is_gpu(device)).name
    found = [Way(own)]
    if every:
        found += [Way(name, layout) for name, layout in layouts().items() if name != own and (name != "flat" or count <= FLAT_AT_MOST)]
    if fast_test:
        texts = {to: (HERE / "fast_test" / Path(to).name).read_text(encoding="utf-8") for to in ("accel/bvh8_block.cl", "shape/triangle_test.cl")}
        found.append(Way("bvh8, fast test", _edges, texts))
    return found


def _edges() -> Any:
    """The accelerator bvh8 with blocks as the fast test wants them: vertex 0, and the edges from it to the others."""
    from lumiere.accel.bvh8 import Bvh8

    class Edges(Bvh8):
        def encode(self, topology: Any, records: np.ndarray) -> dict[str, np.ndarray]:
            arrays = super().encode(topology, records)
            blocks = arrays["blocks"]
            blocks[:, 3:9] -= np.tile(blocks[:, :3], (1, 2, 1))
            return arrays

    return Edges()


def measure(path: Path, device: Any, size: int, runs: int, every_layout: bool, fast_test: bool,
            peer: Callable[..., Embree] | None, robust: bool, folder: Path) -> dict[str, Any]:
    """Figures of the scene at ``path``: by kind of rays, for each way and peer."""
    import pyopencl as cl

    from lumiere.scene.load import load

    scene = load(path)
    context = cl.Context([device])
    queue = cl.CommandQueue(context, device, cl.command_queue_properties.PROFILING_ENABLE)
    count = sum(len(part.records) for shape in scene.geometry for part in shape.lower())
    tracers = {way.name: Tracer(scene, device, context, queue, way) for way in ways(device, count, every_layout, fast_test)}
    own = next(iter(tracers))
    rays = all_rays(scene, tracers[own], size, context, queue)
    peers = []
    if peer is not None:
        peers = [peer(tracers[own].vertices, rays, folder / f"embree-{path.stem}-{flag}", flag) for flag in ([False, True] if robust else [False])]
    everyone: dict[str, Any] = tracers | {other.name: other for other in peers}
    told: dict[str, Any] = {"triangles": count, "own": own, "bytes a triangle": {name: t.bytes / count for name, t in tracers.items()},
                            "node fill": {name: t.fill for name, t in tracers.items() if t.fill is not None},
                            "build, s": {name: who.seconds for name, who in everyone.items()}, "kinds": {}}
    for some in rays:
        agree: dict[str, float] = {}
        results = {}
        for name, who in everyone.items():  # also warms up
            who.trace(some)
            results[name] = who.distances(some) if isinstance(who, Embree) else some.results()[0]
            agree[name] = agreement(some, results[own], results[name])
        times: dict[str, list[float]] = {name: [] for name in everyone}
        for _ in range(runs):
            for name, who in everyone.items():
                let_rest()
                times[name].append(who.trace(some))
        rates = {name: figure([some.count / seconds for seconds in values], "1/s") for name, values in times.items()}
        told["kinds"][some.kind] = {
            "rays": some.count, "rays a second": rates, "agree": agree,
            "by Embree": {name: median(b / a for a, b in zip(times[name], times[peers[0].name], strict=True)) for name in times} if peers else {}}
    for other in peers:
        other.close()
    return told


def node_fill(arrays: Mapping[str, tuple[str, np.ndarray]]) -> float | None:
    """The share of bvh8's child slots that hold one; None for other layouts."""
    nodes = arrays.get("triangle_nodes")
    return float(np.isfinite(nodes[1][:, 0].view(np.float32)).mean()) if nodes is not None and nodes[1].ndim == 3 else None


def table(told: dict[str, Any]) -> str:
    """The figures of all scenes as a Markdown table."""
    lines = ["| scene | rays | by | Mrays/s | least | most | by Embree | agree |", "|---|---|---|---|---|---|---|---|"]
    for scene, part in told.items():
        for kind, of_kind in part["kinds"].items():
            for name, rate in of_kind["rays a second"].items():
                ratio = of_kind["by Embree"].get(name)
                lines.append(f"| {scene} | {kind} | {name} | {rate['median'] / 1e6:.4g} | {rate['min'] / 1e6:.4g} | {rate['max'] / 1e6:.4g} | "
                             f"{'' if ratio is None else f'{ratio:.3f}'} | {of_kind['agree'][name]:.5f} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--device", help="number or part of a name from `lumiere devices` (default: the best)")
    parser.add_argument("--scenes", nargs="+", choices=list(SCENES), default=["million", "20k", "cornell"])
    parser.add_argument("--layouts", action="store_true", help="also every other layout")
    parser.add_argument("--fast-test", action="store_true", help="also bvh8 with a triangle test that is not watertight")
    parser.add_argument("--embree", nargs="?", const="fast", choices=["fast", "robust"], help="beside Embree; robust: also with its robust test")
    parser.add_argument("--peer-python", nargs="+", default=[sys.executable], help="interpreters, one of which has embreex (default: this one)")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--size", type=int, help="pixels of width and height, a multiple of 8 (default: 1024, on a GPU 2896)")
    parser.add_argument("--json", type=Path, help="write all figures to this file")
    options = parser.parse_args()
    from lumiere.device.select import choose
    from lumiere.wavefront.policy import is_gpu

    device = choose(options.device)
    size = options.size or (2896 if is_gpu(device) else 1024)
    told: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        peer = embree(options.peer_python, folder) if options.embree else None
        for scene in options.scenes:
            begin = time.perf_counter()
            told[scene] = measure(write(scene, folder), device, size, options.runs, options.layouts, options.fast_test, peer,
                                  options.embree == "robust", folder)
            tell(f"{scene}: {time.perf_counter() - begin:.0f} s")
    print(f"{device.name.strip()} ({device.platform.name} {device.driver_version})\n\n{table(told)}")
    if options.json:
        options.json.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
