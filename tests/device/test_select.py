"""Listing and choosing devices, on lists made up here and on what this machine has."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from lumiere.device import select
from lumiere.device.select import DeviceInfo, list_devices, missing_linker, pick
from lumiere.errors import DeviceError

POCL = "Portable Computing Language"
GRIND = DeviceInfo(0, "Oclgrind Simulator", "Oclgrind", kind="gpu", driver="OpenCL 1.2 (Oclgrind 21.10)")
POCL30 = DeviceInfo(1, "pthread-AMD EPYC", POCL, kind="cpu", driver="OpenCL 3.0 PoCL 3.0-rc2  Linux, Release, driver 3.0-rc2")
POCL31 = DeviceInfo(2, "pthread-haswell-AMD EPYC", POCL, kind="cpu", driver="OpenCL 3.0 PoCL 3.1+debian  Linux, driver 3.1+debian")
INTEL = DeviceInfo(3, "AMD EPYC", "Intel(R) OpenCL", kind="cpu", driver="OpenCL 3.1 LINUX, driver 2026.22")
LLVMPIPE = DeviceInfo(4, "llvmpipe (LLVM 15)", "rusticl", kind="cpu", driver="OpenCL 3.0")
IGPU = DeviceInfo(5, "UHD 630", "Intel(R) OpenCL Graphics", kind="gpu", compute_units=24, unified_memory=True)
H100 = DeviceInfo(6, "NVIDIA H100", "NVIDIA CUDA", kind="gpu", compute_units=132)
BROKEN = DeviceInfo(None, "", "Clover", error="no device")


@pytest.fixture(autouse=True)
def _with_linker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(select.shutil, "which", lambda name: f"/usr/bin/{name}")


@pytest.mark.parametrize(("listed", "best"), [
    ([GRIND, POCL30, POCL31, INTEL, LLVMPIPE, IGPU, H100, BROKEN], H100),
    ([GRIND, POCL30, POCL31, INTEL, LLVMPIPE, IGPU], IGPU),
    ([GRIND, POCL30, POCL31, INTEL, LLVMPIPE], INTEL),
    ([POCL30, LLVMPIPE, POCL31], POCL31),
    ([LLVMPIPE, POCL30], POCL30),
    ([BROKEN, LLVMPIPE, GRIND], LLVMPIPE),
])
def test_the_default_is_the_best_gpu_else_the_best_cpu(listed: list[DeviceInfo], best: DeviceInfo) -> None:
    assert pick(listed, None) == best
    assert pick(listed[::-1], None) == best


@pytest.mark.parametrize(("wanted", "expected"), [
    (0, GRIND), ("3", INTEL), ("oclGRIND", GRIND), ("pocl", POCL31), ("PoCL 3.0", POCL30), ("h100", H100), ("portable", POCL31), (" nvidia ", H100)])
def test_a_device_is_wanted_by_index_or_part_of_a_name(wanted: str | int, expected: DeviceInfo) -> None:
    assert pick([GRIND, POCL30, POCL31, INTEL, H100], wanted) == expected


@pytest.mark.parametrize("wanted", ["radeon", 7, "7"])
def test_an_unknown_device_is_answered_with_the_known_ones(wanted: str | int) -> None:
    with pytest.raises(DeviceError, match=rf"no OpenCL device '{wanted}', expected one of 1 \(pthread-AMD EPYC\), 6 \(NVIDIA H100\)"):
        pick([BROKEN, POCL30, H100], wanted)


def test_no_device_is_answered_with_how_to_get_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OCL_ICD_VENDORS", raising=False)
    with pytest.raises(DeviceError, match=r"found no OpenCL device \(Clover: no device\); get one with `pip install pocl-binary-distribution`"):
        pick([BROKEN], None)
    with pytest.raises(DeviceError, match="only a simulator, Oclgrind Simulator"):
        pick([GRIND], None)


def test_pocl_without_a_linker_is_refused_before_it_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(select.shutil, "which", lambda name: None)
    assert "`apt install binutils`" in missing_linker(POCL31) and "\n" not in missing_linker(POCL31)
    assert missing_linker(INTEL) is None and missing_linker(H100) is None
    assert missing_linker(DeviceInfo(0, "cpu", POCL, kind="cpu", driver="OpenCL 3.0 PoCL 7.1")) is None
    assert pick([POCL31, LLVMPIPE], None) == LLVMPIPE
    monkeypatch.setattr(select, "list_devices", lambda: [POCL31])
    with pytest.raises(DeviceError, match="apt install binutils"):
        select.choose()


def test_the_environment_names_the_device_where_the_caller_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    marked = [DeviceInfo(0, "one", "p", kind="cpu", device="first"), DeviceInfo(1, "two", "p", kind="cpu", device="second")]
    monkeypatch.setattr(select, "list_devices", lambda: marked)
    monkeypatch.setenv("LUMIERE_DEVICE", "two")
    assert select.choose() == "second"
    assert select.choose("one") == "first"
    monkeypatch.setenv("LUMIERE_DEVICE", "")
    assert select.choose() == "first"


def test_a_broken_platform_does_not_hide_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    import pyopencl as cl

    class Broken:
        name = "Broken"

        def get_devices(self) -> list[object]:
            raise RuntimeError("driver\nfell over")

    class Empty:
        name = "Empty"

        def get_devices(self) -> list[object]:
            return []

    class Odd:
        name = "Odd"

        def get_devices(self) -> list[object]:
            return [object()]

    real = cl.get_platforms()
    monkeypatch.setattr(cl, "get_platforms", lambda: [Broken(), Odd(), *real, Empty()])
    listed = list_devices()
    assert (listed[0].index, listed[0].platform, listed[0].error) == (None, "Broken", "driver fell over")
    assert (listed[1].index, listed[1].platform) == (None, "Odd") and "attribute" in listed[1].error
    assert (listed[-1].platform, listed[-1].error) == ("Empty", "no device")
    assert [info.index for info in listed if info.index is not None] == list(range(sum(len(p.get_devices()) for p in real)))


def test_this_machines_devices_are_described() -> None:
    for info in (info for info in list_devices() if info.index is not None):
        assert info.name and info.platform and info.kind in ("cpu", "gpu", "accelerator")
        assert info.opencl_c[0].isdigit() and info.compute_units > 0
        assert 0 < info.max_allocation <= info.memory


def _python(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], env=os.environ | environment, capture_output=True, text=True, check=False)


def test_a_machine_without_any_runtime_has_no_device(tmp_path: Path) -> None:
    done = _python("from lumiere.device.select import list_devices; print(list_devices())", OCL_ICD_VENDORS=str(tmp_path / "none"))
    assert (done.returncode, done.stdout.strip()) == (0, "[]"), done.stderr


@pytest.mark.skipif(shutil.which("ld") is None, reason="needs a device that works, to see it fail")
def test_pocl_really_needs_ld(tmp_path: Path) -> None:
    """The reason for ``missing_linker``: seen again on the PoCL that is here."""
    pocl = [info for info in list_devices() if select._pocl_version(info) and select._pocl_version(info)[0] < select.POCL_WITH_OWN_LINKER]
    if not pocl:
        pytest.skip("no PoCL older than its own linker here")
    code = f"""
import pyopencl as cl
from lumiere.device.select import list_devices
device = next(i.device for i in list_devices() if i.index == {pocl[0].index})
context = cl.Context([device])
queue = cl.CommandQueue(context)
program = cl.Program(context, "kernel void f(global int *a) {{ a[get_global_id(0)] = 1; }}").build(cache_dir=False)
program.f(queue, (4,), None, cl.Buffer(context, cl.mem_flags.READ_WRITE, 16))
queue.finish()
"""
    without = _python(code, PATH=str(tmp_path), POCL_CACHE_DIR=str(tmp_path / "cache"))
    assert without.returncode != 0 and '"ld"' in without.stderr
