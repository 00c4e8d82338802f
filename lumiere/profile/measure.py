"""The runs that a profile is made of: timed by events, plain, and counted."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from lumiere.overrides import Overrides
from lumiere.profile.compiler import compiled
from lumiere.profile.observe import Census, Count, Launch, Times
from lumiere.profile.traffic import Traffic, copy_bandwidth, path_traffic
from lumiere.rendering import Render
from lumiere.scene.model import Scene
from lumiere.wavefront.source import program_sources

REPEATS = 5
"""Runs of each sort; what is shown is the run of median time."""

LIMITS = {"private_bytes": "PRIVATE_MEM_SIZE", "local_bytes": "LOCAL_MEM_SIZE", "largest_group": "WORK_GROUP_SIZE",
          "group_multiple": "PREFERRED_WORK_GROUP_SIZE_MULTIPLE"}
"""What a driver may tell about a kernel, by OpenCL's names."""


@dataclass
class Run:
    """A run with events: ``wall`` is the host's clock around it, ``host`` the processor time of the thread that launched it; seconds."""

    wall: float
    host: float
    launches: list[Launch] = field(default_factory=list)


@dataclass
class Program:
    """A stage's program: how long it took to have, why it was built, how long compiling it takes and what its kernel needs (None where neither
    the driver nor this run tells)."""

    seconds: float
    reason: str
    compile_seconds: float | None
    limits: dict[str, int | None]
    traffic: Traffic


@dataclass
class Profile:
    """What was measured: a render, its run with events, the times without, the counts, and what the device can do."""

    render: Render
    run: Run
    profiled: list[float]
    """Wall times of the runs with events, seconds."""
    plain: list[float]
    """Wall times of the runs without."""
    counts: dict[tuple[int, int, str], Count]
    """What each launch found and left, by batch, round and stage."""
    paths: dict[tuple[int, int], int]
    """Paths alive, by batch and round."""
    programs: dict[str, Program]
    bandwidth: float
    """Bytes a second that a copy reads and writes."""
    samples: int


def measure(scene: Scene, device: str | int | None = None, load_seconds: float = 0.0, tell: Callable[[str], None] = lambda step: None,
            overrides: Overrides | None = None) -> Profile:
    """Renders ``scene`` eleven times after a run that warms up: in turn with events and without, and once with programs that count. Raises
    DeviceError.
    """
    import pyopencl as cl

    tell("preparing the scene")
    render = Render(scene, device, load_seconds, overrides, profiling=True)
    wavefront = render.wavefront
    with_events = wavefront.queue
    without = cl.CommandQueue(with_events.context, with_events.device)
    tell("warming up")
    _run(render, without, None)
    runs, plain = [], []
    for number in range(REPEATS):
        tell(f"run {number + 1} of {REPEATS}, without events and with")
        for profiled in (False, True) if number % 2 == 0 else (True, False):
            if not profiled:
                plain.append(_run(render, without, None).wall)
                continue
            times = Times()
            run = _run(render, with_events, times)
            run.launches = times.launches()
            runs.append(run)
    tell("asking for what the programs need")
    programs, bandwidth = _programs(render), copy_bandwidth(without)
    tell("counting the paths of each round, and what their rays visit")
    wavefront.count_visits()
    census = Census(wavefront)
    _run(render, without, census)
    middle = sorted(runs, key=lambda run: run.wall)[len(runs) // 2]
    return Profile(render, middle, [run.wall for run in runs], plain, census.counts, census.paths, programs, bandwidth,
                   int(render.counts.sum()))


def _run(render: Render, queue: Any, observer: Callable[[str, int, Any], None] | None) -> Run:
    """One whole render on ``queue``, from an empty film."""
    wavefront = render.wavefront
    wavefront.queue, wavefront.observer = queue, observer
    render.restart(render.scene.sampler.seed)
    wavefront.finish()
    wall, host = time.perf_counter(), time.thread_time()
    render.run()
    run = Run(time.perf_counter() - wall, time.thread_time() - host)
    wavefront.observer = None
    return run


def _programs(render: Render) -> dict[str, Program]:
    wavefront = render.wavefront
    features = wavefront.buffers.features
    sources = program_sources(wavefront.buffers, wavefront.policy)
    programs = {}
    for build, source in zip(wavefront.builds, sources, strict=True):
        stage = source.name.partition("[")[0]
        compiler = compiled(replace(source, options=wavefront.compiler_options(stage)), build, render.device)
        programs[source.name] = Program(build.seconds, build.reason, compiler.seconds, _limits(build, render.device) | {"registers": compiler.registers},
                                        path_traffic(stage, source.text, features))
    return programs


def _limits(build: Any, device: Any) -> dict[str, int | None]:
    """What the driver tells about the kernel of ``build``."""
    import pyopencl as cl

    kernel = cl.Kernel(build.program, build.name.partition("[")[0])
    limits: dict[str, int | None] = {}
    for name, constant in LIMITS.items():
        try:
            limits[name] = int(kernel.get_work_group_info(getattr(cl.kernel_work_group_info, constant), device))
        except cl.Error:
            limits[name] = None
    return limits


def overhead(profile: Profile) -> float:
    """How much longer the fastest run with events took than the fastest without: 0.01 is 1 %. Other work on the machine only ever adds to a run."""
    return min(profile.profiled) / min(profile.plain) - 1.0
