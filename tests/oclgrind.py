"""Runs a module of the tests in Oclgrind, which simulates a device and reports invalid accesses, data races and uses of uninitialised values."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def output_without_reports(tmp_path: Path, check: str, module: str, *arguments: str) -> str:
    """What ``module`` prints under ``check``, an option of Oclgrind's, once it has ended well and nothing was reported. Skips where Oclgrind is not."""
    oclgrind = shutil.which("oclgrind")
    if oclgrind is None:
        pytest.skip("oclgrind is not installed (Debian and Ubuntu: apt install oclgrind)")
    log = tmp_path / "oclgrind.log"
    # Unoptimised: Oclgrind does not know all the intrinsics that LLVM makes of bit reversals and the like.
    command = [oclgrind, "--build-options", "-cl-opt-disable", check, "--max-errors", "10", "--log", str(log), sys.executable, "-m", module, *arguments]
    environment = {key: value for key, value in os.environ.items() if key not in ("OCL_ICD_VENDORS", "LUMIERE_DEVICE")}
    environment |= {"PYTHONPATH": str(ROOT), "LUMIERE_CACHE": str(tmp_path / "programs")}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300, check=False)
    report = log.read_text() if log.exists() else ""
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:] + report[-2000:]
    assert not report, f"Oclgrind reports:\n{report[:4000]}"
    return done.stdout
