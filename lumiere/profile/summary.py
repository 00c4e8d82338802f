"""A profile as plain data: what the JSON file holds, and what the table and the page show."""

from __future__ import annotations

from collections import defaultdict
from statistics import median
from typing import Any

import numpy as np

import lumiere
from lumiere.profile.measure import Profile, overhead
from lumiere.profile.observe import Count, Launch
from lumiere.profile.traffic import queue_bytes
from lumiere.wavefront.source import TRACING, VISIT_BOUNCES

FORMAT = "lumiere profile 2"

DEFINITIONS = (
    "ms, launches: of the stage's kernels, from the device's events. share: of the time of all kernels. Events: the profiled run of median time.",
    "items: what waited for the stage when it started: samples for generate and accumulate, rays for extend and connect, else paths. out: what it "
    "gave to other stages; where that is less, paths ended. Both counted in a run of its own. ns/item: time by items. Mrays/s: items by time.",
    "occupancy: of the work-items launched, those that found an item in the stage's queue.",
    "nodes/ray, prims/ray: nodes of the tree, and primitives in its leaves, that a ray was tested against; counted in the same run, by programs "
    "that are compiled to count and timed by nobody.",
    "moved: bytes of path state, samples and queues that the stage reads and writes: an estimate, each field that its source names counted once an "
    "item each way, and so at most that. Not in it: the scene. tree GB/s: bytes of nodes and primitives that rays asked for, most of which caches "
    "answer.",
    "of copy: what is moved a second, as a share of what the device reads and writes in copying a large buffer. A stage near 100 % waits for memory; "
    "one far below computes, waits for the scene's data, or has too few items.",
    "idle before: time between the end of the kernel before and the start of this one, in all.",
    "compile s: of the program, without what the driver leaves to the first launch. registers, private: of a work-item, words and bytes; local: bytes "
    "of a work-group; group: the largest work-group. –: the driver does not tell.",
)

BOUNCES = (
    "A bounce is the part of a path from one scattering to the next; bounce 0 begins at the camera. It has several "
    "rays where a surface lets the path pass. Shadow rays belong to the bounce at whose end "
    "they start. A launch that holds paths of several bounces gives each a part of its time by its rays; that of rounds without rays is left out.")


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
        "stages": _stages(profile, launches, idle, kernels), "bounces": _bounces(profile, launches), "rounds": _rounds(profile, launches),
        "accelerators": render.wavefront.buffers.features.shapes, "definitions": list(DEFINITIONS)}


def _stages(profile: Profile, launches: list[Launch], idle: list[float], kernels: float) -> list[dict[str, Any]]:
    """One row a stage, in the order of their launches."""
    seconds: dict[str, float] = defaultdict(float)
    waits: dict[str, float] = defaultdict(float)
    number: dict[str, int] = defaultdict(int)
    for launch, gap in zip(launches, idle, strict=True):
        seconds[launch.stage] += launch.seconds
        waits[launch.stage] += gap
        number[launch.stage] += 1
    node_bytes, primitive_bytes = _tree_bytes(profile)
    rows = []
    for stage, program in profile.programs.items():
        time = seconds[stage]
        counts = [count for (_, _, name), count in profile.counts.items() if name == stage]
        items, slots = sum(count.items for count in counts), sum(count.slots for count in counts)
        out: dict[str, int] = defaultdict(int)
        for count in counts:
            for to, given in count.out.items():
                out[to] += given
        moved = program.traffic.bytes * items + queue_bytes(profile.render.wavefront.policy, stage, items, sum(out.values()), slots)
        rays, nodes, primitives = sum((_visits(count).sum(axis=0) for count in counts), np.zeros(3, np.uint64)).tolist()
        tree = None if node_bytes is None or stage not in TRACING else (nodes * node_bytes + primitives * primitive_bytes)
        rows.append({
            "stage": stage, "seconds": time, "share": time / kernels if kernels > 0.0 else 0.0, "launches": number[stage], "items": items,
            "out": dict(out), "occupancy": items / slots if slots and stage != "accumulate" else None,
            "rays_per_second": items / time if stage in TRACING and time > 0.0 else None,
            "nodes_per_ray": nodes / rays if rays else None, "primitives_per_ray": primitives / rays if rays else None,
            "tree_bytes_per_second": tree / time if tree is not None and time > 0.0 else None, "idle_before": waits[stage],
            "state_read_per_item": program.traffic.read, "state_written_per_item": program.traffic.written,
            "samples_per_item": program.traffic.samples, "bytes": moved,
            "bytes_per_second": moved / time if time > 0.0 else 0.0, "share_of_copy": moved / time / profile.bandwidth if time > 0.0 else 0.0,
            "program_seconds": program.seconds, "program_reason": program.reason, "compile_seconds": program.compile_seconds, **program.limits})
    return rows


def _tree_bytes(profile: Profile) -> tuple[float | None, float]:
    """Bytes of a node and of a primitive of the one accelerator that the scene has; None for the first where it has several, or none with nodes."""
    arrays = {name: array for name, (_, array) in profile.render.wavefront.buffers.arrays.items()}
    trees = [shape for shape in profile.render.wavefront.buffers.features.shapes if f"{shape}_nodes" in arrays]
    if len(trees) != 1:
        return None, 0.0
    shape = trees[0]
    primitives = arrays["triangle_vertices"] if shape == "triangle" else arrays[f"{shape}s"]
    nodes = sum(arrays[name].nbytes for name in (f"{shape}_nodes", f"{shape}_children") if name in arrays)
    return nodes / len(arrays[f"{shape}_nodes"]), primitives.nbytes / len(primitives)


def _visits(count: Count) -> np.ndarray:
    """(VISIT_BOUNCES, 3) uint64."""
    return np.zeros((VISIT_BOUNCES, 3), np.uint64) if count.visits is None else count.visits


def _bounces(profile: Profile, launches: list[Launch]) -> list[dict[str, Any]]:
    """One row a bounce: rays by stage, what each visits, and the parts of the stages' times that are its own."""
    totals = {stage: sum((_visits(count) for (_, _, name), count in profile.counts.items() if name == stage), np.zeros((VISIT_BOUNCES, 3), np.uint64))
              for stage in TRACING}
    seconds: dict[str, np.ndarray] = defaultdict(lambda: np.zeros(VISIT_BOUNCES))
    for launch in launches:
        of_rays = profile.counts.get((launch.batch, launch.round, "connect" if launch.stage == "connect" else "extend"))
        weights = np.zeros(VISIT_BOUNCES) if of_rays is None else _visits(of_rays)[:, 0].astype(float)
        if launch.stage == "generate":
            weights = (np.arange(VISIT_BOUNCES) == 0) * weights
        if launch.stage != "accumulate" and weights.sum() > 0.0:
            seconds[launch.stage] += launch.seconds * weights / weights.sum()
    last = max((int(np.flatnonzero(total[:, 0])[-1]) for total in totals.values() if total.any()), default=-1)
    rows = []
    for bounce in range(last + 1):
        row: dict[str, Any] = {"bounce": bounce, "and_more": bounce == VISIT_BOUNCES - 1}
        for stage, total in totals.items():
            rays, nodes, primitives = total[bounce].tolist()
            time = float(seconds[stage][bounce])
            row[stage] = {"rays": rays, "nodes_per_ray": nodes / rays if rays else None, "primitives_per_ray": primitives / rays if rays else None,
                          "rays_per_second": rays / time if time > 0.0 else None}
        row["seconds"] = {stage: float(values[bounce]) for stage, values in seconds.items()}
        rows.append(row)
    return rows


def _rounds(profile: Profile, launches: list[Launch]) -> list[dict[str, Any]]:
    """One row a round: paths alive, and items, work-items and seconds by stage. The batch's ``accumulate`` stands in a last row of its own."""
    seconds: dict[tuple[int, int], dict[str, float]] = defaultdict(dict)
    for launch in launches:
        seconds[launch.batch, launch.round][launch.stage] = launch.seconds
    items: dict[tuple[int, int], dict[str, int]] = defaultdict(dict)
    slots: dict[tuple[int, int], int] = {}
    for (batch, number, stage), count in profile.counts.items():
        items[batch, number][stage] = count.items
        slots[batch, number] = count.slots
    return [{"batch": batch, "round": number, "paths": profile.paths.get((batch, number), 0), "slots": slots.get((batch, number), 0),
             "items": items.get((batch, number), {}), "seconds": seconds[batch, number]} for batch, number in sorted(seconds)]
