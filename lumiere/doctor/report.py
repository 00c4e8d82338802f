"""The report: the machine, the versions, each check and how it was made."""

from __future__ import annotations

import platform
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib import metadata
from typing import Any

import lumiere
from lumiere.device.select import list_devices
from lumiere.doctor.checks import Finding
from lumiere.film.record import record_json

PACKAGES = ("numpy", "pyopencl", "OpenImageIO", "trimesh", "pillow", "platformdirs")


@dataclass(frozen=True)
class Outcome:
    """What a check found, and where it was stopped by an error instead, the ``trace`` of that."""

    name: str
    finding: Finding
    seconds: float
    trace: str = ""


def carry_out(name: str, check: Callable[[Any], Finding], device: Any) -> Outcome:
    """The outcome of ``check``: a driver that refuses to compile or to run has failed it, and the others go on."""
    begin, trace = time.perf_counter(), ""
    try:
        finding = check(device)
    except Exception as error:
        finding = Finding(False, f"stopped by {type(error).__name__}: {str(error).strip().partition(chr(10))[0]}")
        trace = traceback.format_exc()
    return Outcome(name, finding, time.perf_counter() - begin, trace)


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def line(outcome: Outcome) -> str:
    """What came out, in a line."""
    return f"{'ok  ' if outcome.finding.passed else 'FAIL'}  {outcome.name}: {outcome.finding.text} ({outcome.seconds:.1f} s)"


def report(outcomes: Sequence[Outcome], under_way: str | None, device: Any) -> Iterator[str]:
    """The lines of the file, ``device`` being the pyopencl.Device. ``under_way`` names the check that a crash of the driver would end."""
    yield f"Lumière {lumiere.__version__}, Python {platform.python_version()} on {platform.platform()}, {platform.machine()}"
    yield "packages: " + ", ".join(f"{package} {_version(package)}" for package in PACKAGES)
    yield f"arguments: {' '.join(sys.argv[1:])}"
    for info in list_devices():
        chosen = "*" if info.device == device else " "
        yield (f"{chosen} device {info.index}: {info.name}; {info.platform}; {info.driver}; OpenCL C {info.opencl_c}; {info.compute_units} units; "
               f"{info.memory} bytes, {info.max_allocation} in one buffer" + (f"; {info.error}" if info.error else ""))
    yield ""
    yield from map(line, outcomes)
    if under_way is not None:
        yield f"FAIL  {under_way}: was begun, and the program ended before it did"
    for outcome in outcomes:
        if outcome.trace:
            yield f"\n{outcome.name}: {outcome.trace}"
        if outcome.finding.record is not None:
            yield f"\n{outcome.name}: {record_json(outcome.finding.record)}"
