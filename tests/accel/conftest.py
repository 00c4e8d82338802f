"""Every OpenCL device present."""

from __future__ import annotations

import pyopencl as cl
import pytest


def _devices() -> list[cl.Device]:
    try:
        return [device for platform in cl.get_platforms() for device in platform.get_devices()]
    except cl.LogicError:
        return []


@pytest.fixture(scope="session", params=_devices() or [None], ids=lambda device: device.platform.name if device else "none")
def device(request: pytest.FixtureRequest) -> cl.Device:
    if request.param is None:
        pytest.skip("no OpenCL device")
    return request.param
