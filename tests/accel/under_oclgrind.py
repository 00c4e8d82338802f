"""Builds small trees by work-groups on the device that there is; tests/accel/test_oclgrind.py runs this in Oclgrind's process."""

from __future__ import annotations

import sys

import numpy as np
import pyopencl as cl

from lumiere.accel.build import FEW
from lumiere.accel.bvh2 import Bvh2
from lumiere.accel.bvh8 import Bvh8
from lumiere.accel.cwbvh import Cwbvh
from lumiere.accel.device_build import Grain
from lumiere.accel.on_device import OnDevice
from lumiere.device.select import choose
from lumiere.shape.triangle import Triangle


def main() -> None:
    random = np.random.default_rng(1)
    records = np.zeros(150, Triangle.record)
    records["vertices"] = random.random((150, 1, 3)) + random.normal(0.0, 0.01, (150, 3, 3))
    records[:30] = records[0]
    context = cl.Context([choose("oclgrind")])
    queue = cl.CommandQueue(context)
    for layout in (Bvh2(), Bvh8(), Cwbvh()):
        accelerator = OnDevice(layout, context, queue)
        accelerator.builder.grain, accelerator.builder.shares_memory = Grain(group=16, chunk=64, small=FEW, span=8), False
        made = accelerator.accelerate(Triangle, records, np.zeros((150, 3), np.uint32))
        assert np.array_equal(np.sort(made.order), np.arange(150))
        sys.stdout.write(f"built {layout.name}: {made.arrays['nodes'].shape}\n")


if __name__ == "__main__":
    main()
