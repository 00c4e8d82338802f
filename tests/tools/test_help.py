"""Every tool starts and says what it does."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).resolve().parents[2] / "tools"


@pytest.mark.parametrize("tool", [path for path in sorted(TOOLS.glob("*.py")) if "ArgumentParser" in path.read_text(encoding="utf-8")],
                         ids=lambda path: path.stem)
def test_it_says_what_it_does(tool: Path) -> None:
    done = subprocess.run([sys.executable, str(tool), "--help"], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "usage:" in done.stdout, done.stderr
