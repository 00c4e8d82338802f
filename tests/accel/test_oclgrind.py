"""Small trees built in Oclgrind, which simulates a device and reports invalid accesses and data races."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_nothing_to_report(tmp_path: Path) -> None:
    oclgrind = shutil.which("oclgrind")
    if oclgrind is None:
        pytest.skip("oclgrind is not installed (Debian and Ubuntu: apt install oclgrind)")
    log = tmp_path / "oclgrind.log"
    command = [oclgrind, "--build-options", "-cl-opt-disable", "--data-races", "--max-errors", "10", "--log", str(log), sys.executable, "-m",
               "tests.accel.under_oclgrind"]
    environment = {key: value for key, value in os.environ.items() if key not in ("OCL_ICD_VENDORS", "LUMIERE_DEVICE")}
    environment |= {"PYTHONPATH": str(ROOT), "LUMIERE_CACHE": str(tmp_path / "programs")}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300, check=False)
    report = log.read_text() if log.exists() else ""
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:] + report[-2000:]
    assert not report, f"Oclgrind reports:\n{report[:4000]}"
    assert done.stdout.count("built") == 3
