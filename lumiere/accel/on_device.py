"""Which trees the render's device builds, and an accelerator that has it do so."""

from __future__ import annotations

from typing import Any

import numpy as np

from lumiere.accel import Accelerator, Choice
from lumiere.accel.build import Topology
from lumiere.accel.bvh2 import MAX_PRIMITIVES, Bvh2
from lumiere.accel.bvh8 import Bvh8
from lumiere.accel.device_build import BYTES_PER_PRIMITIVE, DeviceBuilder, DeviceTree
from lumiere.wavefront.policy import is_gpu

FROM = 100_000
"""The device builds a tree from so many primitives on: below, numpy is done before the kept program is loaded (docs/performance.md)."""


class OnDevice:
    """What ``layout`` makes, built and encoded on the device of ``queue``; by ``layout`` itself where a leaf holds everything."""

    def __init__(self, layout: Bvh2 | Bvh8, context: Any, queue: Any) -> None:
        self.layout, self.name = layout, layout.name
        self.builder = DeviceBuilder(context, queue, layout.name, layout.max_leaf_size, layout.block)

    def build(self, lower: np.ndarray, upper: np.ndarray) -> Topology | DeviceTree:
        """A tree of the device's, for ``encode``. Boxes as ``lumiere.accel.build.build`` takes them."""
        if len(lower) <= self.layout.max_leaf_size:
            return self.layout.build(lower, upper)
        return self.builder.build(lower, upper)

    def encode(self, tree: Topology | DeviceTree, records: np.ndarray) -> dict[str, np.ndarray]:
        """The arrays that ``layout`` documents."""
        if isinstance(tree, Topology):
            return self.layout.encode(tree, records)
        return self.builder.encode(tree, records)


def on_device(choose: Choice, context: Any, queue: Any,
              wanted: bool | None = None) -> Choice:
    """``choose``, but that the device builds what it chooses: where ``wanted`` is None, CPUs from ``FROM`` primitives on (on GPUs it has yet to be
    measured)."""
    device = queue.device

    def choose_here(shape: str, n_primitives: int, bounded: bool, wide: bool) -> Accelerator:
        accelerator = choose(shape, n_primitives, bounded, wide)
        need = BYTES_PER_PRIMITIVE * n_primitives
        fits = n_primitives < MAX_PRIMITIVES and need < device.global_mem_size // 2 and need // 2 < device.max_mem_alloc_size
        on = n_primitives >= FROM and not is_gpu(device) if wanted is None else wanted
        if isinstance(accelerator, (Bvh2, Bvh8)) and fits and on:
            return OnDevice(accelerator, context, queue)
        return accelerator

    return choose_here
