"""``lumiere render``."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from pathlib import Path
from typing import Any

from lumiere.cli.interrupt import INTERRUPTED, StopOnSignal
from lumiere.cli.progress import ProgressDisplay
from lumiere.cli.values import above_zero, clock, seconds, whole, with_prefix
from lumiere.errors import LumiereError, UsageError

SHOWN_SAMPLES = 3
"""Samples that were not finite, of which the command to replay them is shown."""

OPTIONS = ("spp", "seed", "width", "height", "crop", "max_depth", "device", "time_limit", "target_error")
"""What is handed on to ``lumiere.api.render`` as it is."""


def add(subcommands: Any) -> None:
    """Declares the subcommand's arguments."""
    parser = subcommands.add_parser("render", help="render a scene to picture files", allow_abbrev=False,
                                    description="Renders a scene. Each option stands in for what the scene says.")
    parser.add_argument("scene", metavar="SCENE", help="the scene, a JSON file")
    parser.add_argument("-o", "--output", metavar="FILE", action="append", default=[],
                        help="picture to write: .exr, .png or .jpg; may be given several times (default: the scene's name with .png, here)")
    parser.add_argument("--spp", metavar="N", type=whole(1, 2**31 - 1), help="samples a pixel")
    parser.add_argument("--seed", metavar="S", type=whole(0, 2**32 - 1), help="of the random numbers")
    parser.add_argument("--width", metavar="W", type=whole(1, 65536), help="pixels of the whole picture")
    parser.add_argument("--height", metavar="H", type=whole(1, 65536), help="pixels of the whole picture")
    parser.add_argument("--crop", nargs=4, metavar=("X0", "Y0", "X1", "Y1"), type=whole(0, 65536),
                        help="render only the pixels from (X0, Y0) to before (X1, Y1); (0, 0) is the top left")
    parser.add_argument("--max-depth", metavar="D", type=whole(0, 65535), help="most scattering events on a path")
    parser.add_argument("--device", metavar="DEVICE", help="number or part of a name from `lumiere devices` (default: $LUMIERE_DEVICE, or the best)")
    parser.add_argument("--time-limit", metavar="SECONDS", type=seconds, help="stop rendering after this time, with every pixel sampled equally")
    parser.add_argument("--target-error", metavar="E", type=above_zero,
                        help="render until the picture's relative error is below E, at most --spp samples a pixel")
    parser.add_argument("--record", metavar="FILE", help="write how the picture was made to this JSON file")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Renders, and writes what was asked for; returns the exit status."""
    from lumiere import api
    from lumiere.film.record import write_record
    from lumiere.film.write import check_output

    outputs = [Path(name) for name in options.output] or [Path(f"{Path(options.scene).stem}.png")]
    _check_files(outputs, options)
    display = ProgressDisplay(sys.stderr)
    with StopOnSignal(nothing_yet=lambda: not display.started) as stop:
        scene = api.load(options.scene)
        for path in outputs:
            check_output(path, _size(scene, options))
        wanted = {name: getattr(options, name) for name in OPTIONS if getattr(options, name) is not None}
        try:
            image = api.render(scene, progress=display, stop=stop, **wanted)
        finally:
            display.close()
        writes = [(path, lambda path: image.save(path, scene.film.exposure, scene.film.tonemap)) for path in outputs]
        if options.record is not None:
            writes.append((Path(options.record), lambda path: write_record(image.record, path)))
        _write_all(writes)
    sys.stderr.write(f"lumiere: {_summary(image.record, [path for path, _ in writes], interrupted=stop())}\n")
    for command in _trace_commands(image.record, options):
        sys.stderr.write(f"lumiere: to see what happened there: {command}\n")
    return INTERRUPTED if stop() else 0


def _trace_commands(record: dict[str, Any], options: argparse.Namespace) -> list[str]:
    """`lumiere trace-path` for the first samples that were not finite."""
    given = [f"--{name.replace('_', '-')} {shlex.quote(str(value))}" for name in ("width", "height", "max_depth", "seed", "spp", "device")
             if (value := getattr(options, name)) is not None]
    return [" ".join(["lumiere trace-path", shlex.quote(options.scene), f"--pixel {at['x']} {at['y']}", f"--sample {at['sample']}", *given])
            for at in record.get("non_finite", {}).get("samples", [])[:SHOWN_SAMPLES]]


def _size(scene: Any, options: argparse.Namespace) -> tuple[int, int]:
    """Width and height of the picture in the files."""
    if options.crop is not None:
        x0, y0, x1, y1 = options.crop
    elif scene.film.crop is not None:
        x0, y0, x1, y1 = scene.film.crop
    else:
        x0, y0, x1, y1 = 0, 0, options.width or scene.film.width, options.height or scene.film.height
    return x1 - x0, y1 - y0


def _check_files(outputs: list[Path], options: argparse.Namespace) -> None:
    """Raises UsageError for files that cannot be written, before any time goes into rendering."""
    from lumiere.film.atomic import check_writable
    from lumiere.film.write import check_output

    taken = {os.path.realpath(options.scene): "the scene"}
    for path in [*outputs, *([Path(options.record)] if options.record is not None else [])]:
        place = os.path.realpath(path)
        if place in taken:
            raise UsageError(f"cannot write {path}: it is {taken[place]}")
        taken[place] = "already another output"
    for path in outputs:
        check_output(path)
    if options.record is not None:
        check_writable(options.record)


def _write_all(writes: list[tuple[Path, Any]]) -> None:
    """Writes every file that can be written; then raises the first LumiereError of those that cannot."""
    failures = []
    for path, write in writes:
        try:
            write(path)
        except LumiereError as error:
            failures.append(error)
    if failures:
        raise failures[0]


def _summary(record: dict[str, Any], written: list[Path], *, interrupted: bool) -> str:
    """What was done, in a line."""
    time = record.get("seconds", {}).get("render", 0.0)
    done = f"{record.get('spp')} spp in {clock(time) if time >= 60.0 else f'{time:.3g} s'}"
    rate = with_prefix(record.get("samples_per_second", 0.0), "samples/s")
    bad = record.get("non_finite", {}).get("count", 0)
    goal = record.get("error")
    if goal is not None:
        told = f"error {goal['image']:.2g}, surely below {goal['bound']:.2g}" if "image" in goal else "too few samples to tell the error"
        reached = "reached" if goal["reached"] else "not reached"
        done = f"{told}, target {goal['target']:g} {reached}; {record['mean_spp']:.4g} {done.partition(' ')[2]}"
    return (f"{'interrupted; ' if interrupted else ''}wrote {', '.join(map(str, written))} ({done}, {rate}, {record.get('device')})"
            + _dropped(record.get("triangles_dropped", {})) + (f"; {bad} samples were not finite and count as 0" if bad else ""))


def _dropped(counts: dict[str, int]) -> str:
    """What of the meshes could not be used, by reason."""
    reasons = ", ".join(f"{count} {reason.replace('_', ' ')}" for reason, count in counts.items() if count)
    return f"; triangles left out: {reasons}" if reasons else ""
