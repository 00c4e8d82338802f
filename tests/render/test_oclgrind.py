"""A tiny render in Oclgrind, which simulates a device and reports invalid accesses, data races and uses of uninitialised values."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(("queues", "check", "options"), [
    ("dense", "--data-races", ()),
    ("compacted", "--data-races", ()),
    # Oclgrind 21.10's check itself crashes on the triangle test's vectors.
    ("compacted", "--uninitialized", ("without-triangles",)),
], ids=["dense, races", "compacted, races", "uninitialised"])
def test_nothing_to_report(tmp_path: Path, queues: str, check: str, options: tuple[str, ...]) -> None:
    oclgrind = shutil.which("oclgrind")
    if oclgrind is None:
        pytest.skip("oclgrind is not installed (Debian and Ubuntu: apt install oclgrind)")
    log = tmp_path / "oclgrind.log"
    # Unoptimised: Oclgrind does not know all the intrinsics that LLVM makes of bit reversals and the like.
    command = [oclgrind, "--build-options", "-cl-opt-disable", check, "--max-errors", "10", "--log", str(log),
               sys.executable, "-m", "tests.render.under_oclgrind", str(tmp_path), queues, *options]
    environment = {key: value for key, value in os.environ.items() if key not in ("OCL_ICD_VENDORS", "LUMIERE_DEVICE")}
    environment |= {"PYTHONPATH": str(ROOT), "LUMIERE_CACHE": str(tmp_path / "programs")}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300, check=False)
    report = log.read_text() if log.exists() else ""
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:] + report[-2000:]
    assert not report, f"Oclgrind reports:\n{report[:4000]}"
    mean = float(done.stdout.partition("rendered: mean ")[2].partition(",")[0])
    assert mean > 0.05 and " 0 shadow rays" not in done.stdout, "the picture is too dark to have tested anything"
