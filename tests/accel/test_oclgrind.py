"""Small trees built in Oclgrind: no invalid accesses and no data races."""

from __future__ import annotations

from pathlib import Path

from tests.oclgrind import output_without_reports


def test_nothing_to_report(tmp_path: Path) -> None:
    assert output_without_reports(tmp_path, "--data-races", "tests.accel.under_oclgrind").count("built") == 3
