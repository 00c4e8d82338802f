"""Boxes → tree on the render's device: the builder of ``build.py`` as OpenCL kernels (``cl/accel/build/``), and the layouts' encoders.

Large nodes are split level by level, many work-items a node; small ones by a work-item each, down to the leaves. Every number of a node comes from where
it splits the order of the primitives, and sums are of integers, so the same tree comes out however the work falls.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from lumiere.accel.build import MAX_DEPTH, Topology
from lumiere.device.program import ProgramSource, build_all
from lumiere.device.source import assemble, c_struct

BINS = 16
COUNTERS = ("OPEN", "CHUNKS", "SUBTREES")

NODE = np.dtype([("low", "<f4", 3), ("first", "<u4"), ("high", "<f4", 3), ("link", "<u4")])
"""``link``: an inner node's pair of children, or 1 << 31 | the number of a leaf's."""
OPEN = np.dtype([(name, "<u4") for name in ("slot", "first", "count", "turns", "bounds", "first_chunk")])
CHUNK = np.dtype([(name, "<u4") for name in ("node", "first", "count", "left")])
PLANE = np.dtype([(name, "<u4") for name in ("axis", "last", "middle")])
SUBTREE = np.dtype([(name, "<u4") for name in ("slot", "first", "count", "turns", "level")])
STRUCTS = {"build_node_t": NODE, "open_t": OPEN, "chunk_t": CHUNK, "plane_t": PLANE, "subtree_t": SUBTREE}

BYTES_PER_PRIMITIVE = 190
"""Of device memory, at most, while a tree is built and encoded."""


@dataclass(frozen=True)
class Grain:
    """How work is dealt out. ``group``: work-items that share a chunk of ``chunk`` primitives of a large node; ``small``: the most primitives of a
    subtree that one work-item builds; ``span``: places in the order that one work-item encodes."""

    group: int
    chunk: int
    small: int
    span: int


def grain_for(device: Any, count: int) -> Grain:
    """The grain for ``count`` primitives on ``device`` (a pyopencl.Device)."""
    from lumiere.wavefront.policy import is_gpu

    if is_gpu(device):
        return Grain(group=min(128, device.max_work_group_size), chunk=4096, small=max(64, count >> 15), span=32)
    tasks = 32 * device.max_compute_units
    return Grain(group=1, chunk=max(1024, count // tasks), small=max(1024, count // tasks), span=max(1024, count // tasks))


@dataclass
class DeviceTree:
    """A tree on a device, and what was asked of it on the host. ``order``: (n,) uint32, the primitives in leaf order.

    Its buffers are as ``cl/accel/build/tree.cl`` says; ``ranks``: (n,) uint32, how many inner nodes split the order at or before each place.
    """

    order: np.ndarray
    inner: int
    grain: Grain
    buffers: dict[str, Any]
    subtrees: int


class DeviceBuilder:
    """Builds trees with leaves of at most ``max_leaf_size`` primitives, ``block`` of which are intersected at a time, on the device of ``queue``."""

    def __init__(self, context: Any, queue: Any, layout: str, max_leaf_size: int, block: int, grain: Grain | None = None) -> None:
        self.context, self.queue, self.layout = context, queue, layout
        self.max_leaf_size, self.block, self.grain = max_leaf_size, block, grain
        self._kernels: dict[tuple[int, int], dict[str, Any]] = {}

    def program(self, grain: Grain) -> dict[str, Any]:
        """The kernels by name, built once for a grain."""
        key = (grain.group, 28 if grain.group == 1 else max(2, grain.small.bit_length()))
        if key not in self._kernels:
            program = build_all([self.source(*key)], self.context, self.queue.device)[0].program
            self._kernels[key] = {kernel.function_name: kernel for kernel in program.all_kernels()}
        return self._kernels[key]

    def _launcher(self, grain: Grain) -> Callable[..., Any]:
        """Launches a kernel, by name, for so many independent work-items. Always in groups of one size: PoCL compiles a kernel anew for each."""
        run, size = self.program(grain), min(grain.group, 64)

        def launch(name: str, items: int, *arguments: Any) -> Any:
            return run[name](self.queue, (-(-items // size) * size,), (size,), *arguments)

        return launch

    def source(self, group: int, stack: int) -> ProgramSource:
        """The program, for work-groups of ``group`` and subtrees of less than 2 ** ``stack`` primitives."""
        macros = {"GROUP": group, "SUBTREE_STACK": stack, "BLOCK": self.block, "MAX_LEAF_SIZE": self.max_leaf_size, "MAX_DEPTH": MAX_DEPTH}
        macros |= {f"COUNTER_{name}": number for number, name in enumerate(COUNTERS)}
        prelude = "".join(f"#define {name} {value}u\n" for name, value in macros.items())
        # Intel's compiler else vectorises across work-items, which takes subtrees in lockstep.
        prelude += f"#define KERNEL {'__attribute__((vec_type_hint(float8))) ' if group == 1 else ''}kernel\n"
        prelude += "".join(c_struct(name, dtype) for name, dtype in STRUCTS.items())
        files = ["boxes", "bin", "choose", "partition", "subtrees", "scan", f"encode_{self.layout}"]
        files += ["collapse", "blocks"] if self.layout == "bvh8" else []
        text = "".join(f'#include "accel/build/{name}.cl"\n' for name in files)
        return ProgramSource(f"build[{self.layout}]", assemble("build.cl", prelude, {"build.cl": text}))

    def build(self, lower: np.ndarray, upper: np.ndarray) -> DeviceTree:
        """The tree over boxes (n, 3) float32, finite, ``lower <= upper``, more than a leaf may hold."""
        import pyopencl as cl

        n = len(lower)
        grain = self.grain or grain_for(self.queue.device, n)
        run, launch = self.program(grain), self._launcher(grain)
        queue, allocate, fill = self.queue, self._allocate, self._fill
        sources = [self._input(np.ascontiguousarray(a, np.float32)) for a in (lower, upper)]
        even, odd, nodes = allocate(32 * n), allocate(32 * n), allocate(2 * NODE.itemsize * n)
        turns, marks = allocate(4 * (n // 4 + 1)), allocate(4 * n)
        order = Output(self, n, np.uint32)
        fill(marks, 0), fill(turns, 0)
        open_nodes, chunk_count = n // grain.small + 1, n // grain.chunk + n // grain.small + 2
        opens, chunks = ([allocate(size * most) for _ in range(2)] for size, most in ((OPEN.itemsize, open_nodes), (CHUNK.itemsize, chunk_count)))
        subtrees, planes, counters = allocate(SUBTREE.itemsize * n), allocate(PLANE.itemsize * open_nodes), allocate(4 * len(COUNTERS))
        bounds = allocate(4 * 12)
        fill(bounds, 0xFFFFFFFF)
        items = -(-n // grain.span)
        launch("boxes", items, *sources, np.uint32(n), np.uint32(grain.span), even, bounds)

        totals = np.zeros(len(COUNTERS), np.uint32)
        if n > grain.small:
            first = np.arange(0, n, grain.chunk, dtype=np.uint32)
            rows = np.zeros(len(first), CHUNK)
            rows["first"], rows["count"] = first, np.minimum(grain.chunk, n - first)
            cl.enqueue_copy(queue, chunks[0], rows)
            cl.enqueue_copy(queue, opens[0], np.array([(0, 0, n, 0, 0, 0)], OPEN))
            totals[:2] = 1, len(rows)
        else:
            cl.enqueue_copy(queue, subtrees, np.array([(0, 0, n, 0, 0)], SUBTREE))
            totals[2] = 1
        for level in range(MAX_DEPTH):
            here, chunks_here = int(totals[0]), int(totals[1])
            if not here:
                break
            now, then = level % 2, 1 - level % 2
            primitives, parted = (even, odd) if now == 0 else (odd, even)
            boxes, counts, chunk_counts = allocate(4 * 6 * 3 * BINS * here), allocate(4 * 3 * BINS * here), allocate(4 * 3 * BINS * chunks_here)
            sides = allocate(4 * 24 * here)
            fill(boxes, 0xFFFFFFFF), fill(counts, 0), fill(sides, 0xFFFFFFFF)
            totals[:2] = 0
            cl.enqueue_copy(queue, counters, totals)
            groups, group = (chunks_here * grain.group,), (grain.group,)
            run["bin"](queue, groups, group, opens[now], chunks[now], primitives, bounds, boxes, counts, chunk_counts)
            launch("choose", here, opens[now], np.uint32(here), chunks[now], bounds, boxes, counts, chunk_counts, np.uint32(level),
                          np.uint32(grain.small), np.uint32(grain.chunk), nodes, turns, marks, planes, opens[then], chunks[then], subtrees, counters)
            run["partition"](queue, groups, group, opens[now], chunks[now], planes, primitives, bounds, parted, sides)
            cl.enqueue_copy(queue, totals, counters)
            bounds = sides
        launch("subtrees", int(totals[2]), subtrees, totals[2], even, odd, nodes, turns, marks, order.buffer)
        inner = self._rank(launch, marks, n, grain)
        return DeviceTree(order.fetch(), inner, grain, {"nodes": nodes, "turns": turns, "ranks": marks, "subtrees": subtrees, "kept": even}, int(totals[2]))

    def _rank(self, launch: Callable[..., Any], marks: Any, count: int, grain: Grain) -> int:
        """Turns marks into ranks; returns how many marks there are."""
        import pyopencl as cl

        items = -(-count // grain.span)
        sums, sums_d = np.zeros(items, np.uint32), self._allocate(4 * items)
        launch("count_marks", items, marks, np.uint32(count), np.uint32(grain.span), sums_d)
        cl.enqueue_copy(self.queue, sums, sums_d)
        before = np.cumsum(sums, dtype=np.uint32) - sums
        cl.enqueue_copy(self.queue, sums_d, before)
        launch("rank_marks", items, marks, np.uint32(count), np.uint32(grain.span), sums_d)
        return int(sums.sum())

    def encode(self, tree: DeviceTree, records: np.ndarray) -> dict[str, np.ndarray]:
        """The layout's arrays, for ``records`` in leaf order."""
        return self._encode_bvh8(tree, records) if self.layout == "bvh8" else self._encode_bvh2(tree)

    def _encode_bvh2(self, tree: DeviceTree) -> dict[str, np.ndarray]:
        """What ``Bvh2.encode`` makes."""
        n, grain, b = len(tree.order), tree.grain, tree.buffers
        nodes, children = Output(self, (tree.inner, 12), np.float32), Output(self, (tree.inner, 2), np.uint32)
        self._launcher(grain)("encode_bvh2", -(-n // grain.span), b["nodes"], b["turns"], b["ranks"], np.uint32(n),
                                            np.uint32(grain.span), nodes.buffer, children.buffer)
        return {"nodes": nodes.fetch(), "children": children.fetch()}

    def _encode_bvh8(self, tree: DeviceTree, records: np.ndarray) -> dict[str, np.ndarray]:
        """What ``Bvh8.encode`` makes, but for the order of nodes and blocks."""
        n, grain, b = len(tree.order), tree.grain, tree.buffers
        run, launch, queue = self.program(grain), self._launcher(grain), self.queue
        count, span, small, items = np.uint32(n), np.uint32(grain.span), np.uint32(grain.small), -(-n // grain.span)
        shares, wide, roots = self._allocate(4 * n), self._allocate(4 * n), np.uint32(tree.subtrees)
        self._fill(wide, 0)
        launch("weigh_subtrees", tree.subtrees, b["subtrees"], roots, b["nodes"], b["kept"], shares)
        run["weigh_top"](queue, (1,), (1,), count, small, b["nodes"], b["kept"], shares)
        run["widen_top"](queue, (1,), (1,), count, small, b["nodes"], b["kept"], shares, wide)
        launch("widen_subtrees", tree.subtrees, b["subtrees"], roots, b["nodes"], b["kept"], shares, wide)
        wides = self._rank(launch, wide, n, grain)
        nodes = Output(self, (wides, 8, 8), np.uint32)
        launch("encode_bvh8", items, b["nodes"], b["ranks"], wide, shares, count, span, nodes.buffer)
        blocks = Output(self, (tree.inner + 1, 10, 8), np.float32)
        vertices = self._input(records["vertices"])
        launch("blocks", items, vertices, b["ranks"], count, span, blocks.buffer)
        return {"nodes": nodes.fetch(), "blocks": blocks.fetch()}

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
                        count=count.astype(np.uint32), order=tree.order, depth=len(levels) - 1)

    def _allocate(self, size: int) -> Any:
        import pyopencl as cl

        return cl.Buffer(self.context, cl.mem_flags.READ_WRITE, max(size, 4))

    def _fill(self, buffer: Any, word: int) -> None:
        import pyopencl as cl

        cl.enqueue_fill_buffer(self.queue, buffer, np.uint32(word), 0, buffer.size)

    def _input(self, array: np.ndarray) -> Any:
        import pyopencl as cl

        where = cl.mem_flags.USE_HOST_PTR if self.queue.device.host_unified_memory else cl.mem_flags.COPY_HOST_PTR
        return cl.Buffer(self.context, cl.mem_flags.READ_ONLY | where, hostbuf=np.ascontiguousarray(array))


class Output:
    """An array that the device writes: in place where it shares the host's memory."""

    def __init__(self, builder: DeviceBuilder, shape: Any, dtype: Any) -> None:
        import pyopencl as cl

        self.queue = builder.queue
        size = int(np.prod(shape)) * np.dtype(dtype).itemsize
        page = 4096
        room = np.empty(size + page, np.uint8)
        begin = -room.ctypes.data % page
        self.array = room[begin : begin + size].view(dtype).reshape(shape)
        self.shared = bool(self.queue.device.host_unified_memory)
        flags = cl.mem_flags.READ_WRITE
        self.buffer = cl.Buffer(builder.context, flags | cl.mem_flags.USE_HOST_PTR, hostbuf=self.array) if self.shared else cl.Buffer(
            builder.context, flags, size)

    def fetch(self) -> np.ndarray:
        """The array, once the device has written it."""
        import pyopencl as cl

        if self.shared:
            mapped, _ = cl.enqueue_map_buffer(self.queue, self.buffer, cl.map_flags.READ, 0, self.array.shape, self.array.dtype)
            mapped.base.release(self.queue)
            self.queue.finish()
        else:
            cl.enqueue_copy(self.queue, self.array, self.buffer)
        return self.array
