"""The doctor passes where all is well, and finds out drivers that compute wrongly, refuse to compile, or do not come back."""

from __future__ import annotations

import io
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lumiere.cli.doctor import FAILED
from lumiere.cli.main import main
from lumiere.cli.render import INTERRUPTED
from lumiere.device import source
from lumiere.doctor import checks
from lumiere.doctor.report import carry_out


def _doctor(device: Any, path: Path) -> tuple[int, str]:
    """Exit status and what was printed."""
    text = io.StringIO()
    with redirect_stdout(text):
        status = main(["doctor", "--device", device.name, "-o", str(path)])
    return status, text.getvalue()


def _miscompile(monkeypatch: pytest.MonkeyPatch, file: str, right: str, wrong: str) -> None:
    """From now on programs are built as a driver would that makes ``wrong`` of what stands as ``right`` in ``cl/FILE``."""
    read = source._text

    def wrongly(path: Path) -> str:
        text = read(path)
        if not str(path).endswith(file):
            return text
        assert right in text
        return text.replace(right, wrong)

    monkeypatch.setattr(source, "_text", wrongly)


def test_all_is_well(device: Any, tmp_path: Path) -> None:
    path = tmp_path / "report.txt"
    status, text = _doctor(device, path)
    report = path.read_text(encoding="utf-8")
    assert status == 0 and "all is well" in text and "FAIL" not in report
    assert device.name.strip() in report and '"kernels"' in report
    assert all(f"ok    {name}: " in report for name in checks.CHECKS)


@pytest.mark.parametrize(("name", "file", "right", "wrong"), [
    ("furnace of lambert", "bsdf/lambert.cl", "s.pdf > 0.0f ? 1.0f", "s.pdf > 0.0f ? 0.98f"),
    ("furnace of mirror", "stages/escape.cl", "* radiance);", "* (radiance / 0.0f));"),
    ("χ² of diffuse directions", "lib/warp.cl", "float2_of(r * (wide ? p.x : p.y), r *", "float2_of(0.97f * r * (wide ? p.x : p.y), 0.97f * r *"),
    ("watertightness", "shape/triangle_test.cl", "any(edges < 0.0f) && any(edges > 0.0f)", "any(edges <= 0.0f) && any(edges >= 0.0f)"),
    ("trees", "accel/build/boxes.cl", "high < c ? c : high", "high"),
    ("picture 'glass'", "lib/fresnel.cl", "return 0.5f * (s * s + p * p)", "return 0.25f * (s * s + p * p)"),
], ids=lambda text: text.split("/")[-1] if "/" in text else None)
def test_what_a_driver_miscompiles_is_found(device: Any, monkeypatch: pytest.MonkeyPatch, name: str, file: str, right: str, wrong: str) -> None:
    _miscompile(monkeypatch, file, right, wrong)
    finding = carry_out(name, checks.CHECKS[name], device.name).finding
    assert not finding.passed and "stopped" not in finding.text, finding.text


def test_what_fails_is_reported(device: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wrong results and programs that do not build: a line each, the reason, the other checks all the same, and an exit status of its own."""
    _miscompile(monkeypatch, "bsdf/mirror.cl", "return s;", "return no such thing;")
    stored = checks.stored
    monkeypatch.setattr(checks, "stored", lambda name: (stored(name)[0] * 1.2, stored(name)[1]))
    names = ("furnace of lambert", "furnace of mirror", "picture 'diffuse'")
    monkeypatch.setattr(checks, "CHECKS", {name: checks.CHECKS[name] for name in names})
    path = tmp_path / "report.txt"
    status, text = _doctor(device, path)
    report = path.read_text(encoding="utf-8")
    assert status == FAILED and "failed: furnace of mirror, picture 'diffuse'" in text
    assert "ok    furnace of lambert" in report and "FAIL  picture 'diffuse': largest of" in report
    assert "FAIL  furnace of mirror: stopped by DeviceError" in report and "Traceback" in report


def test_a_driver_that_does_not_come_back_leaves_a_report(device: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def never(device: Any) -> checks.Finding:
        raise KeyboardInterrupt

    monkeypatch.setattr(checks, "CHECKS", {"furnace of mirror": checks.CHECKS["furnace of mirror"], "the one that hangs": never})
    path = tmp_path / "report.txt"
    assert _doctor(device, path)[0] == INTERRUPTED
    report = path.read_text(encoding="utf-8")
    assert "ok    furnace of mirror" in report and "FAIL  the one that hangs: was begun" in report


def test_chi_square_as_a_deviate() -> None:
    random = np.random.default_rng(3)
    expected = np.full(256, 128.0)
    deviates = [checks.chi_square_z(random.poisson(expected), expected) for _ in range(400)]
    assert abs(np.mean(deviates)) < 0.3 and 0.8 < np.std(deviates) < 1.2
    assert checks.chi_square_z(expected * 1.0 + 40.0 * (np.arange(256) % 2), expected) > 10.0


def test_quantile() -> None:
    assert checks.quantile(1) == pytest.approx(4.8916, abs=1e-3)
