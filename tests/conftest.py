"""What all tests share: the device that they run on, and where its programs are kept.

Tests that take the fixture ``device`` are marked ``device``; tools/run_tests.py runs those once on each OpenCL runtime.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if "device" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.device)


def _devices() -> list[Any]:
    """Every OpenCL device that can be used, Oclgrind's simulator aside: tests/render/test_oclgrind.py looks for that itself."""
    from lumiere.device.select import list_devices
    from lumiere.errors import DeviceError

    try:
        return [info.device for info in list_devices() if info.index is not None and not info.matches("oclgrind")]
    except DeviceError:
        return []


@pytest.fixture(scope="session", params=_devices() or [None], ids=lambda device: device.platform.name if device else "none")
def device(request: pytest.FixtureRequest) -> Any:
    """Each OpenCL device present, a pyopencl.Device."""
    if request.param is None:
        pytest.skip("no OpenCL device")
    return request.param


@pytest.fixture(scope="session", autouse=True)
def program_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Programs built by one test serve the others; they are kept in ``LUMIERE_CACHE`` where that is set, else as long as the session."""
    if "LUMIERE_CACHE" in os.environ:
        yield
        return
    os.environ["LUMIERE_CACHE"] = str(tmp_path_factory.mktemp("programs"))
    yield
    del os.environ["LUMIERE_CACHE"]
