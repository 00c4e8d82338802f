"""One OpenCL context a device for all kernels of the tests' own: a driver may hold hundreds of megabytes for each."""

from __future__ import annotations

from functools import cache

import pyopencl as cl


@cache
def context_of(device: cl.Device) -> cl.Context:
    """The context of ``device``."""
    return cl.Context([device])
