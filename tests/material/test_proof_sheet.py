"""A slice of the proof sheet: it measures, draws, and says when something fails."""

from __future__ import annotations

from typing import Any

import pyopencl as cl
import pytest

from lumiere.bsdf import MATERIALS
from tests.bsdf.study import EXAMPLES
from tools import proof_sheet


def test_a_slice(device: cl.Device) -> None:
    page, passed, failed = proof_sheet.make(["lambert"], ["35"], size=8, spp=1, on=[device])
    assert (failed, page.count('class="pass"'), page.count("data:image/png;base64,")) == (0, passed, 2)
    assert passed >= 2 * 6 and "http" not in page


def test_every_kind_has_a_part() -> None:
    assert all(any(m.type == kind for m in EXAMPLES.values()) or kind == "mix" for kind in MATERIALS.kinds())


def test_a_failure_is_seen(device: cl.Device, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise AssertionError

    monkeypatch.setattr(proof_sheet.test_sampling, "test_no_energy_is_made", fails)
    page, _, failed = proof_sheet.make(["mirror"], ["0"], size=8, spp=1, on=[device])
    assert failed == 2 == page.count('class="fail"')
