"""The doctor passes where all is well, and finds out what is not."""

from __future__ import annotations

import io
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lumiere.cli.main import main
from lumiere.doctor import checks


def test_all_is_well(device: Any, tmp_path: Path) -> None:
    path = tmp_path / "report.txt"
    text = io.StringIO()
    with redirect_stdout(text):
        assert main(["doctor", "--device", device.name, "-o", str(path)]) == 0
    report = path.read_text(encoding="utf-8")
    assert "all is well" in text.getvalue() and "FAIL" not in report
    assert device.name.strip() in report and '"kernels"' in report


def test_a_picture_that_is_too_dark_is_found(device: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    stored = checks.stored
    monkeypatch.setattr(checks, "stored", lambda name: (stored(name)[0] * 1.2, stored(name)[1]))
    assert not all(check.passed for check in checks.pictures(device.name))


def test_a_leak_is_found(device: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    load = checks.load

    def with_a_hole(document: Any) -> Any:
        document["scene"]["geometry"][0]["faces"] = document["scene"]["geometry"][0]["faces"][:-900]
        return load(document)

    monkeypatch.setattr(checks, "load", with_a_hole)
    assert not next(checks.watertightness(device.name)).passed


def test_chi_square_as_a_deviate() -> None:
    random = np.random.default_rng(3)
    expected = np.full(256, 128.0)
    deviates = [checks.chi_square_z(random.poisson(expected), expected) for _ in range(400)]
    assert abs(np.mean(deviates)) < 0.3 and 0.8 < np.std(deviates) < 1.2
    assert checks.chi_square_z(expected * 1.0 + 40.0 * (np.arange(256) % 2), expected) > 10.0


def test_quantile() -> None:
    assert checks.quantile(1) == pytest.approx(4.8916, abs=1e-3)
