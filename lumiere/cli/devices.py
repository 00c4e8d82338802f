"""``lumiere devices``."""

from __future__ import annotations

import argparse
import sys
from typing import Any


def add(subcommands: Any) -> None:
    """Declares the subcommand's arguments."""
    parser = subcommands.add_parser("devices", help="list the OpenCL devices", allow_abbrev=False,
                                    description="Lists the OpenCL devices; * marks the one that renders where none is named.")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Lists the devices. Raises DeviceError where there is none."""
    from lumiere.device.select import list_devices, missing_linker, pick, wanted_device

    listed = list_devices()
    chosen = pick(listed, wanted_device())
    lines = []
    for info in listed:
        if info.index is None:
            lines.append(f"  -  {info.platform}: {info.error}")
            continue
        lines.append(f"{'*' if info is chosen else ' '} {info.index}  {info.name} ({info.kind}): {info.platform}")
        lines.append(f"       {info.driver}; OpenCL C {info.opencl_c}; {info.compute_units} compute units; "
                     f"{_gigabytes(info.memory)}, {_gigabytes(info.max_allocation)} in one buffer")
        complaint = missing_linker(info)
        if complaint:
            lines.append(f"       {complaint}")
    sys.stdout.write("\n".join(lines) + "\n")
    return 0


def _gigabytes(size: int) -> str:
    return f"{size / 2**30:.1f} GiB"
