"""The report: the machine, the versions, each check and how it was made."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterator, Sequence
from importlib import metadata

import lumiere
from lumiere.device.select import list_devices
from lumiere.doctor.checks import Check
from lumiere.film.record import record_json

PACKAGES = ("numpy", "pyopencl", "OpenImageIO", "trimesh", "pillow", "platformdirs")


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def line(check: Check) -> str:
    """A check's outcome."""
    return f"{'ok  ' if check.passed else 'FAIL'}  {check.name}: {check.text} ({check.seconds:.1f} s)"


def report(checks: Sequence[Check], device: str) -> Iterator[str]:
    """The lines of the file."""
    yield f"Lumière {lumiere.__version__}, Python {platform.python_version()} on {platform.platform()}, {platform.machine()}"
    yield "packages: " + ", ".join(f"{package} {_version(package)}" for package in PACKAGES)
    yield f"arguments: {' '.join(sys.argv[1:])}"
    for info in list_devices():
        chosen = "*" if info.name == device else " "
        yield (f"{chosen} device {info.index}: {info.name}; {info.platform}; {info.driver}; OpenCL C {info.opencl_c}; {info.compute_units} units; "
               f"{info.memory} bytes, {info.max_allocation} in one buffer" + (f"; {info.error}" if info.error else ""))
    yield ""
    for check in checks:
        yield line(check)
    for check in checks:
        if check.record is not None:
            yield f"\n{check.name}: {record_json(check.record)}"
