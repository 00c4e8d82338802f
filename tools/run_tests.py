"""Runs the tests: those that need no device once, those marked ``device`` once on each OpenCL runtime, in a process of its own.

Every CPU runtime brings an LLVM of its own, so no two share a process. Runtimes are the .icd files of pyopencl's folder (PyPI's PoCL), of
OCL_ICD_VENDORS (a folder or a file) and of the system's folder. Where an .icd file names its library with its folder, that folder joins
LD_LIBRARY_PATH, as Intel's runtime needs it.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SYSTEM_VENDORS = Path("/etc/OpenCL/vendors")
NO_TESTS_COLLECTED = 5

PROBE = """
from lumiere.device.select import list_devices
devices = [info for info in list_devices() if info.index is not None]
print("; ".join(f"{info.name}, {info.driver}" for info in devices))
"""


def icd_files() -> list[Path]:
    """The .icd files of all the runtimes that may be here, each once."""
    places = []
    pyopencl = importlib.util.find_spec("pyopencl")
    if pyopencl is not None and pyopencl.origin is not None:
        places.append(Path(pyopencl.origin).parent / ".libs")
    if os.environ.get("OCL_ICD_VENDORS"):
        places.append(Path(os.environ["OCL_ICD_VENDORS"]))
    places.append(SYSTEM_VENDORS)
    files = []
    for place in places:
        files += [place] if place.is_file() else sorted(place.glob("*.icd")) if place.is_dir() else []
    return list(dict.fromkeys(file.resolve() for file in files))


def environment_of(icd: Path) -> dict[str, str]:
    """The environment of a process that sees the runtime of ``icd`` and no other."""
    environment = os.environ | {"OCL_ICD_VENDORS": str(icd)}
    environment.pop("LUMIERE_DEVICE", None)
    library = Path(icd.read_text(encoding="utf-8").strip())
    if library.is_absolute():
        environment["LD_LIBRARY_PATH"] = os.pathsep.join(filter(None, [str(library.parent), environment.get("LD_LIBRARY_PATH")]))
    return environment


def runtimes() -> list[tuple[str, dict[str, str]]]:
    """Names and environments of the runtimes that have a device."""
    found = []
    for icd in icd_files():
        environment = environment_of(icd)
        probe = subprocess.run([sys.executable, "-c", PROBE], env=environment, capture_output=True, text=True, check=False)
        devices = probe.stdout.strip()
        if probe.returncode == 0 and devices:
            found.append((devices, environment))
        else:
            reason = probe.stderr.strip().splitlines()[-1] if probe.stderr.strip() else "no device"
            print(f"--- {icd}: left out ({reason})", flush=True)
    return found


def pytest(name: str, environment: dict[str, str], arguments: list[str]) -> bool:
    """Runs pytest, and prints what it said when it is done; whether all that was selected has passed."""
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments], env=environment, check=False, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(f"\n=== tests: {name}\n{done.stdout}", flush=True)
    return done.returncode in (0, NO_TESTS_COLLECTED)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--expect", type=int, default=1, metavar="N", help="fail where fewer than N runtimes are found")
    parser.add_argument("arguments", nargs="*", help="for pytest, after --")
    options = parser.parse_args()
    found = runtimes()
    if len(found) < options.expect:
        print(f"found {len(found)} OpenCL runtimes, expected {options.expect}; get one with `pip install pocl-binary-distribution`")
        return 1
    default = found[0][1] if found else dict(os.environ)
    runs = [("without a device", default, "not device"), *((name, env, "device") for name, env in found)]
    # Most of a run is one thread that compiles kernels: two runs at once share two cores well.
    with ThreadPoolExecutor(max_workers=min(2, os.cpu_count() or 1)) as pool:
        passed = list(pool.map(lambda run: pytest(run[0], run[1], ["-m", run[2], *options.arguments]), runs))
    failed = [name for (name, _, _), good in zip(runs, passed, strict=True) if not good]
    print("\n=== " + (f"failed: {'; '.join(failed)}" if failed else f"passed without a device and on {len(found)} OpenCL runtimes"), flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
