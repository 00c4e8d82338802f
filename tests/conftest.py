"""Marks the tests that take the fixture ``device`` as ``device`` tests, which tools/run_tests.py runs once on each OpenCL runtime."""

from __future__ import annotations

import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if "device" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.device)
