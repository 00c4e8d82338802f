"""A profile as plain data: what the JSON file holds, and what the table and the page show."""

from __future__ import annotations

from collections import defaultdict
from statistics import median
from typing import Any

import lumiere
from lumiere.profile.measure import Profile, overhead
from lumiere.profile.observe import Launch

FORMAT = "lumiere profile 1"

RAY_STAGES = ("extend", "connect")
"""Stages whose items are rays."""

DEFINITIONS = (
    "time, launches: of the stage's kernels, from the device's events. share: of the time of all kernels. Events: the profiled run of median time.",
    "items: what waited for the stage when it started: samples for generate and accumulate, rays for extend and connect, else paths; counted in a "
    "run of its own. ns/item: time by items. Mrays/s: items by time.",
    "state: bytes of path state that the stage moves: an estimate, each field that its source reads or writes counted once an item, and so at most "
    "that. Not in it: the scene, the samples and the queues.",
    "of copy: state a second, as a share of what the device reads and writes in copying a large buffer. A stage near 100 % waits for memory; one "
    "far below computes, waits for the scene's data, or has too few items.",
    "idle before: time between the end of the kernel before and the start of this one, in all.",
    "program: seconds to have it, and why it was built. private, local: bytes of memory a work-item and a work-group; group: the largest "
    "work-group; – where the driver does not tell.",
)


def gaps(launches: list[Launch]) -> list[float]:
    """Seconds that the device idled before each launch; 0 before the first."""
    found, end = [], launches[0].start if launches else 0.0
    for launch in launches:
        found.append(max(0.0, launch.start - end))
        end = max(end, launch.end)
    return found


def summary(profile: Profile) -> dict[str, Any]:
    """The profile as JSON has it. Times in seconds, sizes in bytes."""
    render, run = profile.render, profile.run
    launches, idle = run.launches, gaps(run.launches)
    kernels = sum(launch.seconds for launch in launches)
    span = max((launch.end for launch in launches), default=0.0)
    plain = median(profile.plain)
    policy, device = render.wavefront.policy, render.device
    return {
        "format": FORMAT, "version": lumiere.__version__, "scene": str(render.scene.path) if render.scene.path else None,
        "scene_hash": render.scene.text_hash, "width": render.width, "height": render.height, "spp": render.scene.sampler.spp,
        "device": device.name.strip(), "driver": f"{device.platform.name} {device.driver_version}",
        "queues": "compacted" if policy.compacted else "dense", "paths_in_flight": policy.slots, "work_group": policy.work_group,
        "bytes_per_path": render.wavefront.bytes_per_path, "samples": profile.samples, "samples_per_second": profile.samples / plain,
        "copy_bandwidth": profile.bandwidth,
        "seconds": {"load": render.seconds["load"], "accelerator": render.seconds["accelerator"], "compile": render.seconds["compile"],
                    "wall": run.wall, "kernels": kernels, "idle": sum(idle), "before_and_after": max(0.0, run.wall - span), "host_thread": run.host},
        "overhead": {"share": overhead(profile), "with_events": profile.profiled, "without": profile.plain},
        "stages": _stages(profile, launches, idle, kernels), "rounds": _rounds(profile, launches), "definitions": list(DEFINITIONS)}


def _stages(profile: Profile, launches: list[Launch], idle: list[float], kernels: float) -> list[dict[str, Any]]:
    """One row a stage, in the order of their launches."""
    seconds: dict[str, float] = defaultdict(float)
    waits: dict[str, float] = defaultdict(float)
    counts: dict[str, int] = defaultdict(int)
    items: dict[str, int] = defaultdict(int)
    for launch, gap in zip(launches, idle, strict=True):
        seconds[launch.stage] += launch.seconds
        waits[launch.stage] += gap
        counts[launch.stage] += 1
    for (_, _, stage), count in profile.items.items():
        items[stage] += count
    rows = []
    for stage, program in profile.programs.items():
        time, count = seconds[stage], items[stage]
        moved = program.traffic.bytes * count
        rate = moved / time if time > 0.0 else 0.0
        rows.append({
            "stage": stage, "seconds": time, "share": time / kernels if kernels > 0.0 else 0.0, "launches": counts[stage], "items": count,
            "rays_per_second": count / time if stage in RAY_STAGES and time > 0.0 else None, "idle_before": waits[stage],
            "state_read_per_item": program.traffic.read, "state_written_per_item": program.traffic.written, "state_bytes": moved,
            "state_bytes_per_second": rate, "share_of_copy": rate / profile.bandwidth,
            "program_seconds": program.seconds, "program_reason": program.reason, **program.limits})
    return rows


def _rounds(profile: Profile, launches: list[Launch]) -> list[dict[str, Any]]:
    """One row a round: paths alive, and items and seconds by stage. The batch's ``accumulate`` stands in a last row of its own."""
    seconds: dict[tuple[int, int], dict[str, float]] = defaultdict(dict)
    for launch in launches:
        seconds[launch.batch, launch.round][launch.stage] = launch.seconds
    items: dict[tuple[int, int], dict[str, int]] = defaultdict(dict)
    for (batch, number, stage), count in profile.items.items():
        items[batch, number][stage] = count
    return [{"batch": batch, "round": number, "paths": profile.paths.get((batch, number), 0), "items": items.get((batch, number), {}),
             "seconds": seconds[batch, number]} for batch, number in sorted(seconds)]
