"""Which OpenCL devices there are, and which one renders."""

from __future__ import annotations

import os
import re
import shutil
from dataclasses import dataclass
from typing import Any

from lumiere.errors import DeviceError

DEVICE_VARIABLE = "LUMIERE_DEVICE"
"""Environment variable that names the device where the caller does not."""

HOW_TO_GET_ONE = "get one with `pip install pocl-binary-distribution`, or on Debian and Ubuntu with `apt install pocl-opencl-icd`"

POCL_WITH_OWN_LINKER = 7
"""First version of PoCL that is taken to link kernels by itself; those before start the system's ``ld`` for each."""


@dataclass(frozen=True)
class DeviceInfo:
    """One line of the list of devices. A platform that fails, or has no device, is a line too: with ``error``, and no ``index``."""

    index: int | None
    name: str
    platform: str
    kind: str = ""
    """``cpu``, ``gpu`` or ``accelerator``."""
    driver: str = ""
    opencl_c: str = ""
    compute_units: int = 0
    memory: int = 0
    """Bytes of global memory."""
    max_allocation: int = 0
    """Bytes of the largest buffer."""
    unified_memory: bool = False
    """Shares the host's memory: an integrated GPU, or a CPU."""
    error: str = ""
    device: Any = None
    """The pyopencl.Device."""

    def matches(self, text: str) -> bool:
        """Whether ``text`` is part of the device's or its platform's name, or of the driver's version, in any case."""
        return text.casefold() in f"{self.name}\0{self.platform}\0{self.driver}".casefold()


def list_devices() -> list[DeviceInfo]:
    """Every platform's devices, in the order that OpenCL gives. Raises DeviceError where pyopencl cannot be loaded."""
    try:
        import pyopencl as cl
    except Exception as error:
        raise DeviceError(f"cannot load pyopencl ({_line(error)}); reinstall it with `pip install --force-reinstall pyopencl`") from None
    try:
        platforms = cl.get_platforms()
    except cl.Error:  # the loader's way of saying that there are none
        return []
    listed: list[DeviceInfo] = []
    index = 0
    for platform in platforms:
        name = "unknown platform"
        try:
            name = platform.name.strip()
            devices = platform.get_devices()
        except Exception as error:  # a broken driver must not hide the others
            nothing = isinstance(error, cl.Error) and error.code == cl.status_code.DEVICE_NOT_FOUND
            listed.append(DeviceInfo(None, "", name, error="no device" if nothing else _line(error)))
            continue
        if not devices:
            listed.append(DeviceInfo(None, "", name, error="no device"))
        for device in devices:
            try:
                info = _describe(index, device)
            except Exception as error:
                info = DeviceInfo(None, "", name, error=_line(error))
            index += info.index is not None
            listed.append(info)
    return listed


def choose(wanted: str | int | None = None) -> Any:
    """The pyopencl.Device to render on.

    ``wanted`` is an index of ``list_devices``, or part of a device's, platform's or driver's name in any case; None stands for the
    environment variable ``LUMIERE_DEVICE``, or without it for the best GPU, else the best CPU. Raises DeviceError where there is none.
    """
    chosen = pick(list_devices(), wanted_device() if wanted is None else wanted)
    complaint = missing_linker(chosen)
    if complaint:
        raise DeviceError(complaint)
    return chosen.device


def wanted_device() -> str | None:
    """What the environment variable ``LUMIERE_DEVICE`` asks for, or None."""
    return os.environ.get(DEVICE_VARIABLE, "").strip() or None


def pick(listed: list[DeviceInfo], wanted: str | int | None) -> DeviceInfo:
    """The one of ``listed`` that ``choose`` takes. Raises DeviceError where there is none."""
    devices = [info for info in listed if info.index is not None]
    if not devices:
        raise DeviceError(f"found no OpenCL device{_seen(listed)}; {HOW_TO_GET_ONE}")
    if wanted is None:
        candidates = [info for info in devices if not _simulator(info)]
        if not candidates:
            raise DeviceError(f"found only a simulator, {devices[0].name}: ask for it by name; or {HOW_TO_GET_ONE}")
        return max(candidates, key=_rank)
    text = str(wanted).strip()
    if text.isdecimal():
        matching = [info for info in devices if info.index == int(text)]
    else:
        matching = [info for info in devices if info.matches(text)]
    if not matching:
        known = ", ".join(f"{info.index} ({info.name})" for info in devices)
        raise DeviceError(f"found no OpenCL device '{text}', expected one of {known}, or part of one's name")
    return max(matching, key=_rank)


def missing_linker(info: DeviceInfo) -> str | None:
    """What to do where ``info`` is a PoCL that needs a linker that is not there, or None. Without it PoCL fails in the middle of a render."""
    version = _pocl_version(info)
    if version is None or version[0] >= POCL_WITH_OWN_LINKER or info.kind != "cpu" or shutil.which("ld"):
        return None
    return f"{info.name}: found no `ld` on PATH, expected one since PoCL links kernels with it; get one with `apt install binutils`"


def _describe(index: int, device: Any) -> DeviceInfo:
    import pyopencl as cl

    kinds = {cl.device_type.GPU: "gpu", cl.device_type.CPU: "cpu"}
    usable = device.available and device.compiler_available
    return DeviceInfo(
        index=index if usable else None, name=device.name.strip(), platform=device.platform.name.strip(),
        kind=next((kind for bit, kind in kinds.items() if device.type & bit), "accelerator"),
        driver=f"{device.platform.version.strip()}, driver {device.driver_version.strip()}",
        opencl_c=device.opencl_c_version.removeprefix("OpenCL C").strip(), compute_units=device.max_compute_units,
        memory=device.global_mem_size, max_allocation=device.max_mem_alloc_size, unified_memory=bool(device.host_unified_memory),
        error="" if usable else "not available, or without a compiler", device=device)


def _simulator(info: DeviceInfo) -> bool:
    return info.matches("oclgrind")


def _pocl_version(info: DeviceInfo) -> tuple[int, ...] | None:
    """PoCL's (major, minor), or None where the device is not PoCL's."""
    found = re.search(r"\bPoCL (\d+)\.(\d+)", info.driver, re.IGNORECASE)
    return tuple(int(part) for part in found.groups()) if found else None


def _rank(info: DeviceInfo) -> tuple[Any, ...]:
    """Larger is better: GPUs with memory of their own, other GPUs, CPUs; then by compute units.

    Among CPUs one that can link comes first, then Intel's runtime, which vectorises shading best, then the newest PoCL.
    """
    kind = {"gpu": 2, "cpu": 1}.get(info.kind, 0)
    if info.kind == "gpu":
        return (kind, not info.unified_memory, info.compute_units, info.memory, -(info.index or 0))
    family = 2 if info.matches("intel(r) opencl") else 1 if _pocl_version(info) else 0
    return (kind, missing_linker(info) is None, family, _pocl_version(info) or (), -(info.index or 0))


def _seen(listed: list[DeviceInfo]) -> str:
    """Why there may be no device, in brackets."""
    reasons = [f"{info.platform}: {info.error}" for info in listed]
    if "OCL_ICD_VENDORS" in os.environ:
        reasons.append(f"OCL_ICD_VENDORS is {os.environ['OCL_ICD_VENDORS']!r}")
    return f" ({'; '.join(reasons)})" if reasons else ""


def _line(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__
