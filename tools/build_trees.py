"""How long the device takes to build and encode a tree, beside numpy, and what comes out.

    python tools/build_trees.py [--device D] [--faces 20480] [--spheres 50] [--layouts bvh8 bvh2 cwbvh] [--runs 5] [--kernels] [--grain GROUP CHUNK SMALL SPAN]

over the benchmark's mesh (tools/benchmark_scene.py): from vertices in the host's memory until all that a render's kernels read is on the device and the
host has the order of the primitives; then the same with a wait after each part. "First" is with the program from its cache, or built where there is none.
Costs count blocks of primitives.
"""

from __future__ import annotations

import argparse
import statistics
import time
from typing import Any

import numpy as np
from benchmark_scene import displaced_spheres

from lumiere.accel.build import Topology, half_area
from lumiere.accel.bvh2 import Bvh2
from lumiere.accel.bvh8 import Bvh8
from lumiere.accel.cwbvh import Cwbvh
from lumiere.accel.device_build import DeviceBuilder, DeviceTree, Grain
from lumiere.accel.device_encode import encode
from lumiere.accel.on_device import DeviceLayout, OnDevice
from lumiere.device.select import choose
from lumiere.shape.triangle import Triangle


class Timed:
    """A kernel that keeps its events."""

    def __init__(self, kernel: Any, events: list[tuple[str, Any]]) -> None:
        self.kernel, self.events = kernel, events

    def __call__(self, *arguments: Any) -> Any:
        event = self.kernel(*arguments)
        self.events.append((self.kernel.function_name, event))
        return event


def cost(topology: Topology, block: int) -> float:
    """The cost that the builders minimise, in steps."""
    area = half_area(topology.lower.T, topology.upper.T)
    return float(area @ np.where(topology.leaves, -(-topology.count.astype(np.int64) // block), 1) / area[0])


def fill(layout: str, arrays: dict[str, np.ndarray], count: int) -> str:
    """Shares of the places for children and triangles that are taken."""
    if layout == "bvh2":
        return "nodes 100 %"
    if layout == "cwbvh":
        return f"nodes {np.count_nonzero(arrays['nodes'][:, 6:8].copy().view(np.uint8)) / (8 * len(arrays['nodes'])):.0%}"
    present = np.isfinite(arrays["nodes"][:, 0].view(np.float32)).mean()
    return f"nodes {present:.0%}, blocks {count / 8 / len(arrays['blocks']):.0%}"


def kernel_table(accelerator: OnDevice, records: np.ndarray) -> str:
    """Milliseconds by kernel of one build, from events."""
    events: list[tuple[str, Any]] = []
    program = accelerator.builder.program
    accelerator.builder.program = lambda grain: {name: Timed(kernel, events) for name, kernel in program(grain).items()}  # type: ignore[method-assign]
    accelerator.accelerate(Triangle, records)
    accelerator.builder.program = program  # type: ignore[method-assign]
    accelerator.builder.queue.finish()
    totals: dict[str, float] = {}
    for name, event in events:
        totals[name] = totals.get(name, 0.0) + (event.profile.end - event.profile.start) * 1e-6
    return f"{len(events)} launches, {sum(totals.values()):.2f} ms: " + ", ".join(f"{name} {ms:.2f}" for name, ms in totals.items())


PARTS = ("upload", "build", "order and encode", "fetch the order")


def parts(builder: DeviceBuilder, records: np.ndarray) -> tuple[list[float], DeviceTree]:
    """Seconds of each of the ``PARTS`` of what ``OnDevice.accelerate`` does, the device waited for after each; and the tree."""
    moments = [time.perf_counter()]

    def wait() -> None:
        builder.queue.finish()
        moments.append(time.perf_counter())

    given = builder.upload(records)
    wait()
    tree = builder.build_triangles(given["vertices"])
    wait()
    encoded = encode(builder, tree, given)
    wait()
    np.asarray(encoded.order)
    wait()
    return np.diff(moments).tolist(), tree


def measure(layout: DeviceLayout, context: Any, queue: Any, records: np.ndarray, arguments: argparse.Namespace) -> None:
    """Prints the rows of one layout."""
    accelerator = OnDevice(layout, context, queue)
    builder = accelerator.builder
    builder.grain = arguments.grain and Grain(*arguments.grain)
    seconds = []
    for _ in range(arguments.runs + 1):
        begin = time.perf_counter()
        made = accelerator.accelerate(Triangle, records)
        queue.finish()
        seconds.append(time.perf_counter() - begin)
    rows = [parts(builder, records) for _ in range(arguments.runs)]
    by_part = [1e3 * statistics.median(column) for column in zip(*(row for row, _ in rows), strict=True)]
    begin = time.perf_counter()
    topology = layout.build(*Triangle.bounds(records))
    built = time.perf_counter()
    layout.encode(topology, records.take(topology.order))
    numpy_seconds = built - begin, time.perf_counter() - built
    ours, reference = cost(builder.topology(rows[0][1]), layout.block), cost(topology, layout.block)
    arrays = {name: np.asarray(array) for name, array in made.arrays.items()}
    size = sum(array.nbytes for array in arrays.values()) / len(records)
    print(f"{layout.name}, {len(records):,} triangles: device {1e3 * statistics.median(seconds[1:]):.1f} ms, first {1e3 * seconds[0]:.0f} ms; "
          f"numpy {1e3 * numpy_seconds[0]:.0f} and to order vertices and encode {1e3 * numpy_seconds[1]:.0f} ms")
    print("  parts, ms: " + ", ".join(f"{name} {ms:.1f}" for name, ms in zip(PARTS, by_part, strict=True)))
    print(f"  cost {ours:.4f}, numpy's {reference:.4f}; {size:.1f} bytes a triangle beside its vertices, filled: {fill(layout.name, arrays, len(records))}")
    if arguments.kernels:
        print("  " + kernel_table(accelerator, records))


def main() -> None:
    import pyopencl as cl

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--device")
    parser.add_argument("--faces", type=int, default=20480, help="of a sphere: 20, 80, 320, … 20480")
    parser.add_argument("--spheres", type=int, default=50)
    parser.add_argument("--layouts", nargs="+", choices=("bvh8", "bvh2", "cwbvh"), default=("bvh8", "bvh2", "cwbvh"))
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--kernels", action="store_true")
    parser.add_argument("--grain", type=int, nargs=4, metavar=("GROUP", "CHUNK", "SMALL", "SPAN"), help="as lumiere.accel.device_build.Grain")
    arguments = parser.parse_args()
    mesh = displaced_spheres(arguments.spheres, arguments.faces)
    records = np.zeros(len(mesh.faces), Triangle.record)
    records["vertices"] = mesh.triangles
    device = choose(arguments.device)
    print(f"{device.platform.version.strip()}, {device.name.strip()}")
    context = cl.Context([device])
    queue = cl.CommandQueue(context, device, cl.command_queue_properties.PROFILING_ENABLE)
    for layout in (Bvh8(), Bvh2(), Cwbvh()):
        if layout.name in arguments.layouts:
            measure(layout, context, queue, records, arguments)


if __name__ == "__main__":
    main()
