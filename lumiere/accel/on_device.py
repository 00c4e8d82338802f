"""Which trees the render's device builds, and an accelerator that has it do so."""

from __future__ import annotations

from typing import Any

import numpy as np

from lumiere.accel import Accelerated, Accelerator, Choice
from lumiere.accel.bvh2 import MAX_PRIMITIVES, Bvh2
from lumiere.accel.bvh8 import Bvh8
from lumiere.accel.cwbvh import Cwbvh
from lumiere.accel.device_build import BYTES_PER_PRIMITIVE, DeviceBuilder
from lumiere.accel.device_encode import encode
from lumiere.shape import DeviceShape
from lumiere.shape.triangle import Triangle
from lumiere.wavefront.policy import is_gpu

FROM_ON_CPU = 100_000
"""A CPU builds a tree from so many primitives on: below, numpy is done before the kept program is loaded (docs/performance.md)."""

FROM_ON_GPU = 50_000
"""A GPU does from so many on: numpy takes 7 µs each, so that six renders have paid for the two seconds in which NVIDIA's compiler makes the program,
once a machine and driver; with the program kept, a build of so many is over in milliseconds."""

DeviceLayout = Bvh2 | Bvh8 | Cwbvh
"""What the device can encode (device_encode.py)."""


class OnDevice(Accelerator):
    """What ``layout`` makes, built and encoded on the device of ``queue``, where it stays; by ``layout`` itself where a leaf holds everything."""

    def __init__(self, layout: DeviceLayout, context: Any, queue: Any) -> None:
        self.layout, self.name = layout, layout.name  # type: ignore[misc]
        self.builder = DeviceBuilder(context, queue, layout.name, layout.max_leaf_size, layout.block)

    def accelerate(self, shape: type[DeviceShape], records: np.ndarray, corners: np.ndarray | None = None) -> Accelerated:
        """On the device but for ``order``, which the host gets, too; on the host where the device has no room to build."""
        import pyopencl as cl

        if len(records) <= self.layout.max_leaf_size:
            return self.layout.accelerate(shape, records, corners)
        try:
            return self._accelerate(shape, records, corners)
        except (cl.MemoryError, cl.RuntimeError):  # as in lumiere/wavefront/memory.py, which says so where what has to be there does not fit either
            return self.layout.accelerate(shape, records, corners)

    def _accelerate(self, shape: type[DeviceShape], records: np.ndarray, corners: np.ndarray | None) -> Accelerated:
        builder = self.builder
        given = builder.upload(records)
        tree = builder.build_triangles(given["vertices"]) if shape is Triangle else builder.build(*shape.bounds(records))
        made = encode(builder, tree, given)
        ordered_corners = None if corners is None else builder.gather(tree.grain, made.order, builder.upload(corners))
        return Accelerated(np.asarray(made.order), made.records, ordered_corners, {**made.arrays}, tree.low, tree.high)


def on_device(choose: Choice, context: Any, queue: Any, wanted: bool | None = None) -> Choice:
    """``choose``, but that the device builds what it chooses: where ``wanted`` is None, from ``FROM_ON_CPU`` or ``FROM_ON_GPU`` primitives on."""
    device = queue.device
    least = FROM_ON_GPU if is_gpu(device) else FROM_ON_CPU

    def choose_here(shape: str, n_primitives: int, bounded: bool, wide: bool) -> Accelerator:
        accelerator = choose(shape, n_primitives, bounded, wide)
        need = BYTES_PER_PRIMITIVE * n_primitives
        fits = n_primitives < MAX_PRIMITIVES and need < device.global_mem_size // 2 and need // 4 < device.max_mem_alloc_size
        on = n_primitives >= least if wanted is None else wanted
        if isinstance(accelerator, DeviceLayout) and fits and on:
            return OnDevice(accelerator, context, queue)
        return accelerator

    return choose_here
