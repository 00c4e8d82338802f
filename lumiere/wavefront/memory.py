"""Device memory: counted, and refused in one clear line where there is too little."""

from __future__ import annotations

from typing import Any

import numpy as np

from lumiere.device.array import Array, DeviceArray
from lumiere.errors import DeviceError


def _megabytes(count: int) -> str:
    return f"{count / 1e6:,.1f} MB"


class DeviceMemory:
    """Buffers on one device; ``bytes`` is what they take together."""

    def __init__(self, context: Any, queue: Any) -> None:
        self.context = context
        self.queue = queue
        self.device = queue.device
        self.bytes = 0

    def allocate(self, what: str, size: int) -> Any:
        """A buffer of ``size`` bytes, filled with 0 (at least 4: OpenCL has no empty buffers). Raises DeviceError saying how much was needed."""
        import pyopencl as cl

        size = max(4, size)
        limit, total = self.device.max_mem_alloc_size, self.device.global_mem_size
        if size > limit:
            raise DeviceError(f"{self.device.name}: found {_megabytes(size)} needed for {what}, expected at most {_megabytes(limit)} in one buffer; "
                              "render a smaller picture or crop, or fewer triangles")
        if self.bytes + size > total:
            raise self._too_little(what, size)
        try:
            buffer = cl.Buffer(self.context, cl.mem_flags.READ_WRITE, size)
            cl.enqueue_fill_buffer(self.queue, buffer, np.uint32(0), 0, size // 4 * 4)
        except (cl.MemoryError, cl.RuntimeError):
            raise self._too_little(what, size) from None
        self.bytes += size
        return buffer

    def upload(self, what: str, array: Array) -> Any:
        """A buffer that holds ``array``: its own, where it is on the device already."""
        import pyopencl as cl

        if isinstance(array, DeviceArray):
            self.bytes += array.nbytes
            return array.buffer
        buffer = self.allocate(what, array.nbytes)
        if array.nbytes:
            cl.enqueue_copy(self.queue, buffer, array, is_blocking=True)
        return buffer

    def _too_little(self, what: str, size: int) -> DeviceError:
        return DeviceError(f"{self.device.name}: found {_megabytes(self.bytes + size)} of device memory needed with {what}, expected at most "
                           f"{_megabytes(self.device.global_mem_size)}; render a smaller picture or crop, or choose another device")
