"""A profile as text, as JSON and as a trace, and two profiles side by side."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from lumiere.errors import UsageError
from lumiere.profile.bins import bins
from lumiere.profile.measure import Profile
from lumiere.profile.observe import Count
from lumiere.profile.summary import BOUNCES, FORMAT

COLUMNS = ("stage", "ms", "share", "launches", "idle before ms", "items", "out", "occupancy", "ns/item")
"""Of the table of stages."""

MOVED_COLUMNS = ("stage", "Mrays/s", "nodes/ray", "prims/ray", "tree GB/s", "moved MB", "GB/s", "of copy")
"""Of the table of what stages trace and move."""

PROGRAM_COLUMNS = ("program", "compile s", "registers", "private", "local", "group", "had in s", "why it was built")
"""Of the table of programs."""

BOUNCE_COLUMNS = ("bounce", "rays", "nodes/ray", "prims/ray", "Mrays/s", "shadow rays", "nodes/ray", "prims/ray", "Mrays/s", "ms")
"""Of the table of bounces."""

ROUNDS_SHOWN = 20

BAR = 30
"""Characters of the longest bar."""


def number(value: float | None, digits: int = 3) -> str:
    """``value`` with so many significant digits and no exponent; – for None."""
    if value is None:
        return "–"
    if value == 0 or abs(value) >= 10 ** (digits - 1):
        return f"{value:,.0f}"
    return f"{value:.{digits}g}" if abs(value) >= 1e-3 else f"{value:.1e}"


def percent(value: float) -> str:
    """A share as per cent."""
    return f"{100.0 * value:.1f} %"


def stage_cells(row: dict[str, Any]) -> list[str]:
    """A stage's row of the table, in the order of COLUMNS."""
    return [row["stage"], number(1e3 * row["seconds"]), percent(row["share"]), number(row["launches"]), number(1e3 * row["idle_before"]),
            f"{row['items']:,}", f"{sum(row['out'].values()):,}" if row["out"] else "–", "–" if row["occupancy"] is None else percent(row["occupancy"]),
            number(1e9 * row["seconds"] / row["items"] if row["items"] else None)]


def moved_cells(row: dict[str, Any]) -> list[str]:
    """A stage's row of the table of what it traces and moves, in the order of MOVED_COLUMNS."""
    tree = row["tree_bytes_per_second"]
    return [row["stage"], _millions(row["rays_per_second"]), number(row["nodes_per_ray"]), number(row["primitives_per_ray"]),
            number(None if tree is None else tree / 1e9), number(row["bytes"] / 1e6), number(row["bytes_per_second"] / 1e9),
            percent(row["share_of_copy"])]


def _millions(rate: float | None) -> str:
    return number(None if rate is None else rate / 1e6)


def program_cells(row: dict[str, Any]) -> list[str]:
    """A stage's row of the table of programs, in the order of PROGRAM_COLUMNS."""
    return [row["stage"], number(row["compile_seconds"]), number(row["registers"]), number(row["private_bytes"]), number(row["local_bytes"]),
            number(row["largest_group"]), number(row["program_seconds"]), row["program_reason"]]


def bounce_cells(row: dict[str, Any]) -> list[str]:
    """A bounce's row, in the order of BOUNCE_COLUMNS."""
    cells = [f"{row['bounce']}{'+' if row['and_more'] else ''}"]
    for stage in ("extend", "connect"):
        part = row[stage]
        cells += [f"{part['rays']:,}", number(part["nodes_per_ray"]), number(part["primitives_per_ray"]), _millions(part["rays_per_second"])]
    return [*cells, number(1e3 * sum(row["seconds"].values()))]


def headline(told: dict[str, Any]) -> list[str]:
    """What was rendered, on what, and where the time went, in a few lines."""
    seconds, over = told["seconds"], told["overhead"]
    wall = seconds["wall"] or 1.0
    return [
        f"{told['scene'] or 'scene'}: {told['width']} × {told['height']}, {told['spp']} spp on {told['device']} ({told['driver']})",
        f"accelerators: {_layouts(told)}",
        f"{told['samples_per_second'] / 1e6:.3g} million samples a second, measured without events; {told['queues']} queues, "
        f"{told['paths_in_flight']:,} paths in flight of {told['bytes_per_path']} bytes, work-groups of {told['work_group']}; "
        f"a copy moves {told['copy_bandwidth'] / 1e9:.3g} GB/s",
        f"{1e3 * wall:.4g} ms of wall time: kernels {percent(seconds['kernels'] / wall)}, device idle between kernels "
        f"{percent(seconds['idle'] / wall)}, before and after {percent(seconds['before_and_after'] / wall)}; "
        f"the host's thread worked {1e3 * seconds['host_thread']:.3g} ms",
        _empty(told["rounds"]),
        f"before that: load {seconds['load']:.3g} s, accelerator {seconds['accelerator']:.3g} s, upload and programs {seconds['compile']:.3g} s",
        f"profiling costs {percent(over['share'])}: the fastest of {len(over['with_events'])} runs with events by that of as many without, in turn "
        f"(with: {_span(over['with_events'])}; without: {_span(over['without'])})"]


DOES = {"generate": "starting paths at the camera", "extend": "finding what rays meet", "escape": "what lies beyond the scene",
        "scatter": "scattering inside bodies", "shade": "materials, and choosing light and direction", "connect": "finding whether lights are hidden",
        "accumulate": "adding samples to the picture"}
"""What a stage's time goes into."""

NEAR_COPY, BUSY = 0.6, 0.95


def findings(told: dict[str, Any]) -> list[str]:
    """What a reader should know first, in whole sentences."""
    by_time = sorted(told["stages"], key=lambda row: -row["seconds"])
    said = [f"{row['stage']} takes {percent(row['share'])} of the kernels' time: {DOES[row['stage'].partition('[')[0]]}." for row in by_time[:3]]
    busy = told["seconds"]["kernels"] / (told["seconds"]["wall"] or 1.0)
    said.append(f"The device worked {percent(busy)} of the time" + (": the host does not hold it up." if busy > BUSY else
                "; else it waited for the host or the driver, or had nothing left to do."))
    nearest = max(told["stages"], key=lambda row: row["share_of_copy"])
    near = nearest["share_of_copy"] > NEAR_COPY
    said.append(f"{nearest['stage']} comes nearest to the speed of memory, {percent(nearest['share_of_copy'])} of what a copy reaches: "
                + ("it waits for what it reads and writes of paths." if near else "no stage waits for what it reads and writes of paths."))
    extend = next(row for row in told["stages"] if row["stage"] == "extend")
    if extend["nodes_per_ray"] is not None:
        said.append(f"A ray visits {number(extend['nodes_per_ray'])} nodes of the trees and is tested against "
                    f"{number(extend['primitives_per_ray'])} primitives.")
    return [*said, f"The profiler itself costs {percent(told['overhead']['share'])}; negative: less than runs differ."]


def _layouts(told: dict[str, Any]) -> str:
    return ", ".join(f"{layout} of {shape}s" for shape, layout in told["accelerators"].items()) or "none"


def _empty(rounds: list[dict[str, Any]]) -> str:
    """What the rounds cost that found no path alive: the host had launched them before it knew."""
    times = [(r["paths"], sum(r["seconds"].values())) for r in rounds if "generate" in r["seconds"]]
    lost = [seconds for paths, seconds in times if paths == 0]
    return (f"{len(times)} rounds; {len(lost)} of them began when no path was alive, and took {1e3 * sum(lost):.3g} ms "
            f"({percent(sum(lost) / (sum(seconds for _, seconds in times) or 1.0))} of all rounds)")


def _span(times: list[float]) -> str:
    return f"{1e3 * min(times):.4g}–{1e3 * max(times):.4g} ms"


def _aligned(rows: list[list[str]]) -> list[str]:
    """Columns padded: the first to the left, the others to the right; a rule below the heads."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["  ".join([row[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))]) for row in rows]
    return [lines[0], "-" * len(lines[0]), *lines[1:]]


def rounds_text(told: dict[str, Any]) -> list[str]:
    """The population by round, with a bar."""
    stages = [row["stage"] for row in told["stages"] if row["stage"] != "accumulate"]
    parts = bins(told["rounds"], stages, ROUNDS_SHOWN)
    most = max((part.paths for part in parts), default=0.0) or 1.0
    rows = [["round", "paths alive", "started", *(["shadow rays"] if "connect" in stages else []), "ms"]]
    rows += [[part.label, f"{part.paths:,.0f}", f"{part.items['generate']:,.0f}",
              *([f"{part.items['connect']:,.0f}"] if "connect" in stages else []), number(1e3 * sum(part.seconds.values()))] for part in parts]
    lines = _aligned(rows)
    return lines[:2] + [f"{line}  {'#' * round(BAR * part.paths / most)}" for line, part in zip(lines[2:], parts, strict=True)]


def table_text(told: dict[str, Any]) -> str:
    """Everything for a terminal."""
    table = _aligned([list(COLUMNS), *(stage_cells(row) for row in told["stages"])])
    moved = _aligned([list(MOVED_COLUMNS), *(moved_cells(row) for row in told["stages"])])
    programs = _aligned([list(PROGRAM_COLUMNS), *(program_cells(row) for row in told["stages"])])
    by_bounce = _aligned([list(BOUNCE_COLUMNS), *map(bounce_cells, told["bounces"])])
    lines = [*headline(told), "", *table, "", *moved, "", *programs, "", "by bounce", *by_bounce, "",
             "population by round (means where rounds are taken together; ms: all their kernels)", *rounds_text(told), "", *told["definitions"],
             BOUNCES]
    return "\n".join(lines) + "\n"


def summary_json(told: dict[str, Any]) -> str:
    """The summary as JSON text."""
    return json.dumps(told, indent=1, ensure_ascii=False) + "\n"


def trace_json(profile: Profile) -> str:
    """Chrome's trace event format, for Perfetto or chrome://tracing: a track with the kernels, and the paths alive as a counter. Times in µs."""
    device = profile.render.device.name.strip()
    events: list[dict[str, Any]] = [{"ph": "M", "pid": 1, "name": "process_name", "args": {"name": device}},
                                    {"ph": "M", "pid": 1, "tid": 1, "name": "thread_name", "args": {"name": "kernels"}}]
    for launch in profile.run.launches:
        key = (launch.batch, launch.round)
        if launch.stage == "generate":
            events.append({"ph": "C", "pid": 1, "name": "paths alive", "ts": 1e6 * launch.start, "args": {"paths": profile.paths.get(key, 0)}})
        count = profile.counts.get((*key, launch.stage), Count(0, 0, {}))
        events.append({"ph": "X", "pid": 1, "tid": 1, "cat": "kernel", "name": launch.stage, "ts": 1e6 * launch.start, "dur": 1e6 * launch.seconds,
                       "args": {"batch": launch.batch, "round": launch.round, "items": count.items, "slots": count.slots, "out": count.out}})
    return json.dumps({"displayTimeUnit": "ms", "traceEvents": events}, ensure_ascii=False) + "\n"


def read_summary(path: Path) -> dict[str, Any]:
    """A summary from its JSON file. Raises UsageError where the file is none."""
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}") from None
    except ValueError:
        raise UsageError(f"{path}: found no JSON, expected a file that `lumiere profile --json` wrote") from None
    found = told.get("format") if isinstance(told, dict) else None
    if found != FORMAT:
        raise UsageError(f"{path}: found the format {found!r}, expected {FORMAT!r}, as `lumiere profile --json` writes")
    return told


def _ratio(a: float, b: float) -> str:
    return f"{b / a:.3f}" if a > 0.0 else "–"


def compare_text(a: dict[str, Any], b: dict[str, Any]) -> str:
    """B by A: nanoseconds a sample of each stage and of the whole, and rays a second. Times below 1 are faster in B, rates above 1."""
    def per_sample(told: dict[str, Any], seconds: float) -> float:
        return 1e9 * seconds / max(1, told["samples"])

    rows = [["", "A", "B", "B / A"]]

    def add(name: str, x: float, y: float) -> None:
        rows.append([name, number(x, 4), number(y, 4), _ratio(x, y)])

    stages = [{row["stage"]: row for row in told["stages"]} for told in (a, b)]
    none = {"seconds": 0.0, "rays_per_second": None, "nodes_per_ray": None, "primitives_per_ray": None}
    for stage in dict.fromkeys([*stages[0], *stages[1]]):
        x, y = (rows_of.get(stage, none) for rows_of in stages)
        add(f"{stage}, ns/sample", per_sample(a, x["seconds"]), per_sample(b, y["seconds"]))
        if x["rays_per_second"] and y["rays_per_second"]:
            add(f"{stage}, Mrays/s", x["rays_per_second"] / 1e6, y["rays_per_second"] / 1e6)
        for key, name in (("nodes_per_ray", "nodes/ray"), ("primitives_per_ray", "prims/ray")):
            if x[key] is not None and y[key] is not None:
                add(f"{stage}, {name}", x[key], y[key])
    for name in ("kernels", "idle", "wall"):
        add(f"{name}, ns/sample", per_sample(a, a["seconds"][name]), per_sample(b, b["seconds"][name]))
    add("Msamples/s", a["samples_per_second"] / 1e6, b["samples_per_second"] / 1e6)
    add("copy, GB/s", a["copy_bandwidth"] / 1e9, b["copy_bandwidth"] / 1e9)
    heads = [f"{name}: {told['scene'] or 'scene'}, {told['width']} × {told['height']}, {told['spp']} spp, {told['device']}, "
             f"version {told['version']}, {_layouts(told)}"
             for name, told in (("A", a), ("B", b))]
    if a["scene_hash"] != b["scene_hash"] or a["device"] != b["device"]:
        heads.append("The two are not of one scene on one device.")
    return "\n".join([*heads, "", *_aligned(rows)]) + "\n"
