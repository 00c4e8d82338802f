"""Boxes → tree on the render's device: the builder of ``build.py`` as OpenCL kernels (``cl/accel/build/``), and the layouts' encoders.

Large nodes are split level by level, many work-items a node; small ones by a work-item each, down to the leaves. Every number of a node comes from where
it splits the order of the primitives, and sums are of integers, so the same tree comes out however the work falls.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from lumiere.accel.build import BINS, FEW, MAX_DEPTH, Topology
from lumiere.device.array import DeviceArray
from lumiere.device.program import ProgramSource, build_all
from lumiere.device.source import assemble, c_struct

LOOK_EVERY = 2
"""Levels between two looks of the host at how many large nodes are left, from the first level on that may be without."""

NODE = np.dtype([("low", "<f4", 3), ("first", "<u4"), ("high", "<f4", 3), ("link", "<u4")])
"""``link``: an inner node's pair of children, or 1 << 31 | the number of a leaf's."""
OPEN = np.dtype([(name, "<u4") for name in ("slot", "first", "count", "turns", "bounds", "first_chunk")])
CHUNK = np.dtype([(name, "<u4") for name in ("node", "first", "count", "left")])
PLANE = np.dtype([(name, "<u4") for name in ("axis", "last", "middle")])
SUBTREE = np.dtype([(name, "<u4") for name in ("slot", "first", "count", "turns", "level")])
COUNTERS = np.dtype([("room", "<u4"), ("subtrees", "<u4"), ("open", "<u4", MAX_DEPTH + LOOK_EVERY + 1), ("chunks", "<u4", MAX_DEPTH + LOOK_EVERY + 1)])
"""For how many large nodes of a level there is room; how many subtrees there are; and by level how many large nodes and chunks of them."""
FILES = {"bvh2": ["encode_bvh2"], "bvh8": ["collapse", "encode_bvh8", "blocks"], "cwbvh": ["collapse", "arrange_cwbvh", "encode_cwbvh"]}
"""Of ``cl/accel/build``, those that encode a layout."""
STRUCTS = {"build_node_t": NODE, "open_t": OPEN, "chunk_t": CHUNK, "plane_t": PLANE, "subtree_t": SUBTREE, "counters_t": COUNTERS}

BYTES_PER_PRIMITIVE = 280
"""Of device memory, at most, while a tree is built and encoded."""


@dataclass(frozen=True)
class Grain:
    """How work is dealt out. ``group``: work-items that share a chunk of ``chunk`` primitives of a large node; ``small``: the most primitives of a
    subtree that one work-item builds, at least ``FEW``; ``span``: places in the order that one work-item encodes."""

    group: int
    chunk: int
    small: int
    span: int

    @property
    def rows(self) -> int:
        """Rows that one work-item writes, where each is more work than a place of the order."""
        return self.span if self.group == 1 else 1


def grain_for(device: Any, count: int) -> Grain:
    """The grain for ``count`` primitives on ``device`` (a pyopencl.Device)."""
    from lumiere.wavefront.policy import is_gpu

    if is_gpu(device):
        return Grain(group=min(128, device.max_work_group_size), chunk=4096, small=max(FEW, count >> 15), span=32)
    tasks = 32 * device.max_compute_units
    return Grain(group=1, chunk=max(1024, count // tasks), small=max(1024, count // tasks), span=max(1024, count // tasks))


@dataclass
class DeviceTree:
    """A tree on a device. ``order``: (n,) uint32, the primitives in leaf order; ``low``, ``high``: (3,) float32, the root's box, on the host.

    Its buffers are as ``cl/accel/build/tree.cl`` says; ``ranks``: (n,) uint32, how many inner nodes split the order at or before each place;
    ``planes`` and ``counters`` tell the large nodes of each level, of which there are ``large``.
    """

    order: DeviceArray
    inner: int
    grain: Grain
    buffers: dict[str, Any]
    subtrees: int
    large: list[int]
    low: np.ndarray
    high: np.ndarray


class DeviceBuilder:
    """Builds trees with leaves of at most ``max_leaf_size`` primitives, ``block`` of which are intersected at a time, on the device of ``queue``.

    ``shares_memory``: kernels may read the host's arrays where they are; by default where the device says so.
    """

    def __init__(self, context: Any, queue: Any, layout: str, max_leaf_size: int, block: int, grain: Grain | None = None,
                 shares_memory: bool | None = None) -> None:
        self.context, self.queue, self.layout = context, queue, layout
        self.max_leaf_size, self.block, self.grain = max_leaf_size, block, grain
        self.shares_memory = shares_memory
        self._kernels: dict[tuple[int, int], dict[str, Any]] = {}

    def program(self, grain: Grain) -> dict[str, Any]:
        """The kernels by name, built once for a grain."""
        key = (grain.group, 28 if grain.group == 1 else max(2, grain.small.bit_length()))
        if key not in self._kernels:
            program = build_all([self.source(*key)], self.context, self.queue.device)[0].program
            self._kernels[key] = {kernel.function_name: kernel for kernel in program.all_kernels()}
        return self._kernels[key]

    def launcher(self, grain: Grain) -> Callable[..., Any]:
        """Launches a kernel, by name, for so many independent work-items. Always in groups of one size: PoCL compiles a kernel anew for each."""
        run, size = self.program(grain), min(grain.group, 64)

        def launch(name: str, items: int, *arguments: Any) -> Any:
            return run[name](self.queue, (-(-items // size) * size,), (size,), *arguments)

        return launch

    def source(self, group: int, stack: int) -> ProgramSource:
        """The program, for work-groups of ``group`` and subtrees of less than 2 ** ``stack`` primitives."""
        macros = {"GROUP": group, "SUBTREE_STACK": stack, "BINS": BINS, "FEW": FEW, "BLOCK": self.block, "MAX_LEAF_SIZE": self.max_leaf_size,
                  "MAX_DEPTH": MAX_DEPTH}
        prelude = "".join(f"#define {name} {value}u\n" for name, value in macros.items())
        # Intel's compiler else vectorises across work-items, which takes subtrees in lockstep.
        prelude += f"#define KERNEL {'__attribute__((vec_type_hint(float8))) ' if group == 1 else ''}kernel\n"
        # A GPU's compiler may unroll the loops over bins and axes, within one another: its time grows with that, and the arrays are in memory either way.
        prelude += "#define ROLLED\n" if group == 1 else '#define ROLLED _Pragma("unroll 1")\n'
        prelude += "".join(c_struct(name, dtype) for name, dtype in STRUCTS.items())
        files = ["boxes", "bin", "choose", "partition", "subtrees", "scan", "gather", *FILES[self.layout]]
        text = "".join(f'#include "accel/build/{name}.cl"\n' for name in files)
        return ProgramSource(f"build[{self.layout}]", assemble("build.cl", prelude, {"build.cl": text}))

    def build(self, lower: np.ndarray, upper: np.ndarray) -> DeviceTree:
        """The tree over boxes (n, 3) float32, finite, ``lower <= upper``, more than a leaf may hold."""
        return self._build("boxes", self.upload(lower), self.upload(upper))

    def build_triangles(self, vertices: DeviceArray) -> DeviceTree:
        """The tree over triangles (n, 3, 3) float32, finite, more than a leaf may hold."""
        return self._build("triangle_boxes", vertices)

    def _build(self, boxes: str, *sources: DeviceArray) -> DeviceTree:
        """The tree over what the kernel called ``boxes`` makes of the arrays ``sources``."""
        import pyopencl as cl

        n = len(sources[0])
        grain = self.grain or grain_for(self.queue.device, n)
        launch, allocate, most_open = self.launcher(grain), self.allocate, n // grain.small + 1
        primitives, order = (allocate(32 * n), allocate(32 * n)), self.array(n, np.uint32)
        # Of either side of a level's nodes. The root is in place of the left one of a level before the first.
        bounds = allocate(4 * 24 * most_open), allocate(4 * 24 * most_open)
        buffers = {"nodes": allocate(2 * NODE.itemsize * n), "turns": allocate(n + 4, 0), "ranks": allocate(4 * n, 0),
                   "subtrees": allocate(SUBTREE.itemsize * n), "planes": allocate(PLANE.itemsize * most_open * (MAX_DEPTH + LOOK_EVERY)),
                   "counters": allocate(COUNTERS.itemsize), "kept": primitives[0]}
        cl.enqueue_fill_buffer(self.queue, bounds[1], np.uint32(0xFFFFFFFF), 0, 4 * 12)
        launch(boxes, -(-n // grain.span), *(source.buffer for source in sources), np.uint32(n), np.uint32(grain.span), primitives[0], bounds[1])
        if n > grain.small:
            counts = self._split_large(n, grain, primitives, bounds, buffers)
        else:
            counts = np.zeros(1, COUNTERS)
            counts["subtrees"] = 1
            cl.enqueue_copy(self.queue, buffers["subtrees"], np.array([(0, 0, n, 0, 0)], SUBTREE))
        subtrees, large = int(counts["subtrees"][0]), counts["open"][0].tolist()
        launch("subtrees", subtrees, buffers["subtrees"], np.uint32(subtrees), *primitives, buffers["nodes"], buffers["turns"], buffers["ranks"],
               order.buffer)
        inner = self.rank(buffers["ranks"], n, grain)
        root = np.zeros(1, NODE)
        cl.enqueue_copy(self.queue, root, buffers["nodes"])
        return DeviceTree(order, inner, grain, buffers, subtrees, large[: large.index(0)], root["low"][0], root["high"][0])

    def _split_large(self, n: int, grain: Grain, primitives: tuple[Any, Any], bounds: tuple[Any, Any], buffers: dict[str, Any]) -> np.ndarray:
        """Splits all nodes of more than ``grain.small`` primitives; returns the counters. The host waits for as few levels as it can: kernels see for
        themselves how many nodes a level has."""
        import pyopencl as cl

        run, launch, allocate = self.program(grain), self.launcher(grain), self.allocate
        most_open, most_chunks = n // grain.small + 1, n // grain.chunk + n // grain.small + 2
        opens, chunks = ([allocate(dtype.itemsize * most) for _ in range(2)] for dtype, most in ((OPEN, most_open), (CHUNK, most_chunks)))
        histograms = allocate(4 * 6 * 3 * BINS * most_open, 0xFFFFFFFF), allocate(4 * 3 * BINS * most_open, 0)
        chunk_counts = allocate(4 * 3 * BINS * most_chunks)
        first = np.arange(0, n, grain.chunk, dtype=np.uint32)
        rows, counts = np.zeros(len(first), CHUNK), np.zeros(1, COUNTERS)
        rows["first"], rows["count"] = first, np.minimum(grain.chunk, n - first)
        counts["room"], counts["open"][0, 0], counts["chunks"][0, 0] = most_open, 1, len(rows)
        cl.enqueue_copy(self.queue, chunks[0], rows)
        cl.enqueue_copy(self.queue, opens[0], np.array([(0, 0, n, 0, 0, 0)], OPEN))
        cl.enqueue_copy(self.queue, buffers["counters"], counts)
        largest, most = n, 1
        for level in range(MAX_DEPTH + LOOK_EVERY):
            # The largest node of a level holds at least half of what that of the level before does.
            if largest <= grain.small:
                cl.enqueue_copy(self.queue, counts, buffers["counters"])
                most = int(counts["open"][0, level])
                if most == 0:
                    break
                largest = grain.small << LOOK_EVERY
            now, then = level % 2, 1 - level % 2
            groups, group, at = (min(n // grain.chunk + most, most_chunks) * grain.group,), (grain.group,), (buffers["counters"], np.uint32(level))
            run["bin"](self.queue, groups, group, *at, opens[now], chunks[now], primitives[now], bounds[then], *histograms, chunk_counts)
            launch("choose", most, *at, opens[now], chunks[now], bounds[then], *histograms, chunk_counts, np.uint32(grain.small),
                   np.uint32(grain.chunk), buffers["nodes"], buffers["turns"], buffers["ranks"], buffers["planes"], bounds[now], opens[then], chunks[then],
                   buffers["subtrees"])
            run["partition"](self.queue, groups, group, *at, opens[now], chunks[now], buffers["planes"], primitives[now], bounds[then],
                             primitives[then], bounds[now], *histograms)
            largest, most = -(-largest // 2), min(2 * most, most_open)
        return counts

    def rank(self, marks: Any, count: int, grain: Grain) -> int:
        """Turns ``count`` marks, 0, 1 or more, into sums up to and with each; returns the sum of all."""
        import pyopencl as cl

        launch, items = self.launcher(grain), -(-count // grain.span)
        sums, sums_d = np.zeros(items, np.uint32), self.allocate(4 * items)
        launch("count_marks", items, marks, np.uint32(count), np.uint32(grain.span), sums_d)
        cl.enqueue_copy(self.queue, sums, sums_d)
        before = np.cumsum(sums, dtype=np.uint32) - sums
        cl.enqueue_copy(self.queue, sums_d, before)
        launch("rank_marks", items, marks, np.uint32(count), np.uint32(grain.span), sums_d)
        return int(sums.sum())

    def topology(self, tree: DeviceTree) -> Topology:
        """The tree as the other encoders take it."""
        import pyopencl as cl

        n = len(tree.order)
        rows, turns, ranks = np.zeros(2 * n, NODE), np.zeros(n, np.uint8), np.zeros(n, np.uint32)
        cl.enqueue_copy(self.queue, rows, tree.buffers["nodes"])
        cl.enqueue_copy(self.queue, turns, tree.buffers["turns"])
        pairs = np.flatnonzero(turns)
        ranks[pairs] = np.arange(len(pairs))
        slots = np.concatenate([[0], np.stack([2 * pairs, 2 * pairs + 1], axis=1).ravel()])
        rows = rows[slots]
        leaves = rows["link"] >> 31 == 1
        link = rows["link"].astype(np.int64)
        left = np.where(leaves, -1, 2 * ranks[np.where(leaves, 0, link)].astype(np.int64) + 1)
        first = rows["first"].astype(np.int64)
        # Leaves' counts, and inner nodes' from the leaves within, level by level.
        count = np.where(leaves, link & 0x7FFFFFFF, 0)
        level, levels = np.zeros(1, np.int64), []
        while len(level):
            levels.append(level)
            level = left[level][~leaves[level]]
            level = np.stack([level, level + 1], axis=1).ravel()
        for level in reversed(levels):
            inner = level[~leaves[level]]
            count[inner] = count[left[inner]] + count[left[inner] + 1]
        return Topology(lower=rows["low"].copy(), upper=rows["high"].copy(), left=left.astype(np.int32), first=first.astype(np.uint32),
                        count=count.astype(np.uint32), order=np.asarray(tree.order), depth=len(levels) - 1)

    def gather(self, grain: Grain, order: DeviceArray, records: DeviceArray) -> DeviceArray:
        """The ``records`` (n, …), of 4-byte words, in ``order``."""
        n = len(order)
        ordered = self.array(records.shape, records.dtype)
        self.launcher(grain)("gather", -(-n // grain.rows), records.buffer, order.buffer, np.uint32(records.nbytes // (4 * n)), np.uint32(n),
                             np.uint32(grain.rows), ordered.buffer)
        return ordered

    def upload(self, array: np.ndarray) -> DeviceArray:
        """``array`` for kernels to read: in place where the device shares the host's memory."""
        import pyopencl as cl

        array = np.ascontiguousarray(array)
        shares = self.queue.device.host_unified_memory if self.shares_memory is None else self.shares_memory
        if shares:
            buffer = cl.Buffer(self.context, cl.mem_flags.READ_ONLY | cl.mem_flags.USE_HOST_PTR, hostbuf=array)
        else:
            buffer = self.allocate(array.nbytes)
            cl.enqueue_copy(self.queue, buffer, array)
        return DeviceArray(self.queue, buffer, array.shape, array.dtype)

    def array(self, shape: int | tuple[int, ...], dtype: Any) -> DeviceArray:
        """An array for kernels to write."""
        shape = (shape,) if isinstance(shape, int) else shape
        return DeviceArray(self.queue, self.allocate(int(np.prod(shape)) * np.dtype(dtype).itemsize), shape, dtype)

    def allocate(self, size: int, word: int | None = None) -> Any:
        """A buffer, filled with ``word`` where one is given."""
        import pyopencl as cl

        buffer = cl.Buffer(self.context, cl.mem_flags.READ_WRITE, max(size, 4))
        if word is not None:
            cl.enqueue_fill_buffer(self.queue, buffer, np.uint32(word), 0, size // 4 * 4)
        return buffer
