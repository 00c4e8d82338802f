"""Every extreme comes out as expected, on every device."""

from __future__ import annotations

from typing import Any

import pytest

from tests.extremes.cases import CASES, Case

QUICK = 0.25
"""Of the samples that tools/extremes.py takes."""


@pytest.mark.parametrize("case", [case for case in CASES if not case.slow], ids=lambda case: case.name)
def test_extreme(case: Case, device: Any) -> None:
    outcome = case.run(device.name, QUICK)
    assert outcome.passed, outcome.text
