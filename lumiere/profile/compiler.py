"""What the device's compiler takes and tells."""

from __future__ import annotations

import re
import time
import uuid
from dataclasses import dataclass
from typing import Any

from lumiere.device.program import Build, ProgramSource

VERBOSE = "-cl-nv-verbose"
"""Has compilers that know the extension ``cl_nv_compiler_options`` write what a kernel needs into the build's log."""

_REGISTERS = re.compile(r"Used (\d+) registers")


@dataclass(frozen=True)
class Compiler:
    """Seconds that compiling a program takes, and registers of its kernel; None where that cannot be had."""

    seconds: float | None
    registers: int | None


def registers(log: str) -> int | None:
    """Registers a work-item, from the log of a program with one kernel."""
    found = _REGISTERS.search(log)
    return int(found[1]) if found else None


def compiled(source: ProgramSource, build: Build, device: Any) -> Compiler:
    """Compiles the program once more where the driver tells about it, or where ``build`` took a kept binary; drivers that keep what they compile
    to themselves, and compile at a kernel's first launch, tell nothing.
    """
    import pyopencl as cl

    verbose = "cl_nv_compiler_options" in device.extensions
    if not verbose and not build.reason.startswith("none"):
        return Compiler(build.seconds, None)
    if not verbose and build.reason != "none: kept binary":
        return Compiler(None, None)
    # A name that no program has had, so that the driver does not take the text for one that it has kept.
    text = f"#define PROFILED_{uuid.uuid4().hex}\n{source.text}"
    options = [*source.options, VERBOSE] if verbose else list(source.options)
    begin = time.perf_counter()
    try:
        program = cl.Program(build.program.context, text)
        program.build(options=options, devices=[device], cache_dir=False)
    except cl.Error:
        return Compiler(None, None)
    seconds = time.perf_counter() - begin
    return Compiler(seconds, registers(program.get_build_info(device, cl.program_build_info.LOG) or "") if verbose else None)
