"""Load, build and upload, and samples a second beside other renderers, for tools/benchmark.py."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from benchmark_figure import figure, let_rest, tell
from benchmark_peer import RENDERERS, RendererPeer, export, interpreter

MAX_DEPTH = 7

BLOCKS = 8
"""Pictures are compared by the means of so many blocks a side."""

MOST_SPP = 1024


def benchmark_scene(path: Path, size: tuple[int, int], spp: int) -> Any:
    """The scene at ``path`` with the benchmark's integrator."""
    from lumiere import api

    scene = api.with_options(api.load(path), {"width": size[0], "height": size[1], "spp": spp, "max_depth": MAX_DEPTH})
    return replace(scene, integrator=replace(scene.integrator, russian_roulette_depth=None))


def prepare(path: Path, size: tuple[int, int], spp: int, device: str | None) -> Any:
    """A Render of the same."""
    from lumiere.rendering import Render

    begin = time.perf_counter()
    scene = benchmark_scene(path, size, spp)
    return Render(scene, device, time.perf_counter() - begin, profiling=True)


def preparation(path: Path, runs: int, device: str | None) -> dict[str, Any]:
    """What comes before the first sample: load, accelerator, upload, and programs from the cache."""
    from lumiere.wavefront.memory import DeviceMemory

    times: dict[str, list[float]] = {name: [] for name in ("load", "accelerator", "upload", "upload and programs")}
    for _ in range(runs):
        render = prepare(path, (64, 64), 1, device)
        wavefront = render.wavefront
        memory = DeviceMemory(wavefront.context, wavefront.queue)
        begin = time.perf_counter()
        kept = [memory.upload(name, array) for name, (_, array) in wavefront.buffers.arrays.items()]
        wavefront.finish()
        times["upload"].append(time.perf_counter() - begin)
        del kept
        times["load"].append(render.seconds["load"])
        times["accelerator"].append(render.seconds["accelerator"])
        times["upload and programs"].append(render.seconds["compile"])
    arrays = wavefront.buffers.arrays
    return {name: figure(values, "s") for name, values in times.items()} | {
        "triangles": arrays["triangle_vertices"][1].nbytes // 36, "bytes": wavefront.buffers.bytes,
        "bytes of accelerators": sum(array.nbytes for name, (_, array) in arrays.items() if name.startswith("triangle_"))}


def doubled(seconds: float, run: Any) -> int:
    """The least power of two, from 4 up, for which ``run(spp)`` says that it takes about ``seconds``."""
    spp = 4
    while spp < MOST_SPP and (taken := run(spp)) < seconds / 1.5:
        spp = min(MOST_SPP, 2 * spp if taken <= 0.0 else max(2 * spp, 1 << round(np.log2(spp * seconds / taken))))
    return spp


def sized(path: Path, size: tuple[int, int], device: str | None, seconds: float) -> Any:
    """A warm Render whose spp, a power of two, takes about ``seconds``."""
    render = prepare(path, size, 4, device)

    def run(spp: int) -> float:
        nonlocal render
        if spp != render.scene.sampler.spp:
            render = prepare(path, size, spp, device)
        for seed in (0, 1):  # the first one warms up
            render.restart(seed)
            render.run()
        return render.seconds["render"]

    run(spp := doubled(seconds, run))
    assert render.scene.sampler.spp == spp
    return render


def started(scene: Any, folder: Path, pythons: Sequence[str], gpu: bool) -> list[RendererPeer]:
    """Every renderer that there is, on ``scene``; a word about each that there is not."""
    if not pythons:
        return []
    export(scene, folder, variant="cuda_ad_rgb" if gpu else "llvm_ad_rgb")
    found = []
    for renderer in RENDERERS:
        python = interpreter(renderer, pythons)
        if gpu and not renderer.gpu:
            tell(f"left out: {renderer.name}, which is measured on CPUs alone")
        elif python is None:
            tell(f"left out: {renderer.name}, which {' or '.join(pythons)} cannot import; get it with `pip install {renderer.package}`")
        else:
            try:
                found.append(RendererPeer(renderer, python, folder))
            except RuntimeError as error:
                tell(f"left out: {error}")
    return found


def blocks(picture: np.ndarray) -> np.ndarray:
    """(BLOCKS, BLOCKS, 3) means of a picture (height, width, 3), whose last rows and columns are left out where they do not divide."""
    height, width = (BLOCKS * (length // BLOCKS) for length in picture.shape[:2])
    return picture[:height, :width].reshape(BLOCKS, height // BLOCKS, BLOCKS, width // BLOCKS, 3).mean(axis=(1, 3), dtype=np.float64)


def speed(path: Path, size: tuple[int, int], runs: int, seconds: float, device: str | None, pythons: Sequence[str], folder: Path) -> dict[str, Any]:
    """Samples a second of ours and of the peers, in turn, each with so many spp that it takes about ``seconds``; and rays a second by kind."""
    import pyopencl as cl

    from lumiere.wavefront.policy import is_gpu

    render = sized(path, size, device, seconds)
    wavefront = render.wavefront
    with_events, wavefront.queue = wavefront.queue, cl.CommandQueue(wavefront.context, render.device)
    others = started(render.scene, folder, pythons, is_gpu(render.device))
    pixels = size[0] * size[1]
    for peer in others:
        peer.render(0, 1)  # compiles
    spps = {peer.name: doubled(seconds, lambda spp, peer=peer: peer.render(0, spp)) for peer in others}
    ours: list[float] = []
    theirs: dict[str, list[float]] = {peer.name: [] for peer in others}
    for seed in range(1, runs + 1):
        render.restart(seed)
        wavefront.finish()
        let_rest()
        render.run()
        ours.append(render.samples / render.seconds["render"])
        for peer in others:
            let_rest()
            theirs[peer.name].append(pixels * spps[peer.name] / peer.render(seed, spps[peer.name]))
    picture = render.image({}).pixels
    wavefront.queue = with_events
    rows = {}
    for peer in others:
        other, values = peer.picture(), theirs[peer.name]
        peer.close()
        rows[peer.name] = {"spp": spps[peer.name], "samples a second": figure(values, "1/s"), "mean": float(other.mean()),
                           "ours by it": median(a / b for a, b in zip(ours, values, strict=True)),
                           "blocks differ by": float(np.abs(blocks(other) - blocks(picture)).mean() / picture.mean())}
    return {"width": size[0], "height": size[1], "spp": render.scene.sampler.spp, "samples a second": figure(ours, "1/s"),
            "mean": float(picture.mean()), "rays a second": ray_rates(render, runs), "peers": rows}


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
