"""Programs: built once a source, options, device and driver; binaries are kept on disk; every build says why it was needed."""

from __future__ import annotations

import hashlib
import os
import tempfile
import time
import warnings
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lumiere.errors import DeviceError


@dataclass(frozen=True)
class ProgramSource:
    """A program to build: its ``name`` (the stage, with the kind in brackets where there are several), text and compiler options."""

    name: str
    text: str
    options: tuple[str, ...] = ()


@dataclass
class Build:
    """A built program, why it was built, and how long that took in seconds."""

    name: str
    program: Any
    reason: str
    seconds: float
    keep_at: Path | None = None


def cache_folder() -> Path:
    """Where binaries are kept: ``LUMIERE_CACHE`` or the user's cache folder."""
    given = os.environ.get("LUMIERE_CACHE")
    if given:
        return Path(given)
    from platformdirs import user_cache_dir

    return Path(user_cache_dir("lumiere")) / "programs"


def _key(source: ProgramSource, device: Any) -> str:
    identity = [source.text, *source.options, device.platform.name, device.platform.version, device.name, device.vendor, device.version,
                device.driver_version]
    return hashlib.sha256("\0".join(identity).encode()).hexdigest()


def _store(path: Path, binary: bytes) -> None:
    """Writes beside, then renames. A cache that cannot be written only costs time."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(binary)
        os.replace(name, path)
    except OSError:
        return


def _driver_keeps(device: Any) -> bool:
    """PoCL keeps what it compiles by itself; to ask it for a binary has every kernel compiled once more (cold start of the Cornell box: 8.4 s of
    processor time with, 5.4 s without)."""
    return device.platform.name in ("Portable Computing Language", "Oclgrind")  # Oclgrind does not take its own binaries back


def _failure(source: ProgramSource, device: Any, log: str) -> DeviceError:
    with tempfile.NamedTemporaryFile("w", prefix="lumiere-build-", suffix=".log", delete=False, encoding="utf-8") as file:
        file.write(f"{log}\n\n{source.text}")
    return DeviceError(f"{device.name}: found a compiler failure in program '{source.name}', expected it to build; "
                       f"report the log and source in {file.name}")


def build(source: ProgramSource, context: Any, device: Any) -> Build:
    """Builds ``source`` for ``device``, from the kept binary where there is one. Raises DeviceError naming a file with the log."""
    import pyopencl as cl

    begin = time.perf_counter()
    path = cache_folder() / f"{_key(source, device)}.bin"
    reason = "new source, options, device or driver"
    if path.is_file() and _driver_keeps(device):
        reason = "none: kept by the driver"
    elif path.is_file():
        try:
            program = cl.Program(context, [device], [path.read_bytes()])
            program.build(options=list(source.options))
            return Build(source.name, program, "none: kept binary", time.perf_counter() - begin)
        except (cl.Error, OSError):
            reason = "the kept binary was refused"
    try:
        program = cl.Program(context, source.text)
        program.build(options=list(source.options), devices=[device], cache_dir=False)
    except cl.Error as error:
        raise _failure(source, device, str(error)) from None
    return Build(source.name, program, reason, time.perf_counter() - begin, path)


def _keep(built: Build) -> None:
    """Keeps the binary of a program that was built anew; a note that there is one where the driver keeps it."""
    import pyopencl as cl

    if built.keep_at is None:
        return
    if _driver_keeps(built.program.devices[0]):
        _store(built.keep_at, b"")
        return
    binaries = built.program.get_info(cl.program_info.BINARIES)
    if binaries and binaries[0]:
        _store(built.keep_at, binaries[0])


def build_all(sources: Sequence[ProgramSource], context: Any, device: Any) -> list[Build]:
    """Builds several programs side by side, the longest first."""
    import pyopencl as cl

    # Oclgrind's compiler does not survive company.
    workers = 1 if device.platform.name == "Oclgrind" else max(1, min(len(sources), os.cpu_count() or 1))
    with warnings.catch_warnings(), ThreadPoolExecutor(max_workers=workers) as pool:
        warnings.simplefilter("ignore", cl.CompilerWarning)  # Intel's runtime keeps a log where all is well
        longest_first = sorted(sources, key=lambda source: len(source.text), reverse=True)
        building = {source.name: pool.submit(build, source, context, device) for source in longest_first}
        builds = [building[source.name].result() for source in sources]
    for built in builds:
        _keep(built)
    return builds
