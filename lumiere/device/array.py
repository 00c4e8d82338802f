"""Arrays that lie on the device: what kernels made and kernels read need not pass through the host."""

from __future__ import annotations

from typing import Any

import numpy as np


class DeviceArray:
    """An array of ``shape`` and ``dtype`` in ``buffer``, of the context of ``queue``, in which all that writes it has been launched.

    ``np.asarray`` fetches a copy.
    """

    def __init__(self, queue: Any, buffer: Any, shape: tuple[int, ...], dtype: Any) -> None:
        self.queue, self.buffer, self.shape, self.dtype = queue, buffer, shape, np.dtype(dtype)

    @property
    def nbytes(self) -> int:
        """Bytes of the elements."""
        return int(np.prod(self.shape)) * self.dtype.itemsize

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, name: str) -> DeviceArray:
        """The field of records that have no other."""
        if self.dtype.names != (name,):
            raise KeyError(f"found the field '{name}' wanted of records of {self.dtype}, expected their only one")
        field = self.dtype[name]
        return DeviceArray(self.queue, self.buffer, self.shape + field.shape, field.base)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        import pyopencl as cl

        array = np.empty(self.shape, self.dtype)
        if self.nbytes:
            cl.enqueue_copy(self.queue, array, self.buffer, is_blocking=True)
        return array if dtype is None else array.astype(dtype, copy=False)


Array = np.ndarray | DeviceArray
