"""A tiny render in Oclgrind: no invalid accesses, no data races, no uses of uninitialised values."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.oclgrind import output_without_reports


@pytest.mark.parametrize(("queues", "check", "options"), [
    ("dense", "--data-races", ()),
    ("dense", "--data-races", ("in-lanes",)),
    ("compacted", "--data-races", ()),
    # Oclgrind 21.10's check itself crashes on the triangle test's vectors.
    ("compacted", "--uninitialized", ("without-triangles",)),
], ids=["dense, races", "in lanes, races", "compacted, races", "uninitialised"])
def test_nothing_to_report(tmp_path: Path, queues: str, check: str, options: tuple[str, ...]) -> None:
    printed = output_without_reports(tmp_path, check, "tests.render.under_oclgrind", str(tmp_path), queues, *options)
    mean = float(printed.partition("rendered: mean ")[2].partition(",")[0])
    assert mean > 0.05 and " 0 shadow rays" not in printed, "the picture is too dark to have tested anything"
