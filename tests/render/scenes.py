"""Scenes and renders that tests share."""

from __future__ import annotations

from functools import cache

import pyopencl as cl

from lumiere.device.select import list_devices


@cache
def index_of(device: cl.Device) -> int:
    """The index by which ``lumiere.render`` takes ``device``."""
    return next(info.index for info in list_devices() if info.device == device)
