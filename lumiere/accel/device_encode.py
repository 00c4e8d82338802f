"""A tree on the device → the arrays of a layout, and records in the order that it wants; all of it on the device."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from lumiere.accel.collapse import WIDTH
from lumiere.accel.device_build import DeviceBuilder, DeviceTree
from lumiere.device.array import DeviceArray


@dataclass
class Encoded:
    """``order``: (n,) uint32, the primitives in the order in which they have to be stored; their ``records`` in it; the layout's ``arrays``."""

    order: DeviceArray
    records: DeviceArray
    arrays: dict[str, DeviceArray]


def encode(builder: DeviceBuilder, tree: DeviceTree, records: DeviceArray) -> Encoded:
    """What the layout of ``builder`` makes of ``tree`` and of ``records``, which are in the order that the tree was given."""
    return {"bvh2": _bvh2, "bvh8": _bvh8, "cwbvh": _cwbvh}[builder.layout](builder, tree, records)


def _bvh2(builder: DeviceBuilder, tree: DeviceTree, records: DeviceArray) -> Encoded:
    """As ``Bvh2.encode``."""
    n, grain, b = len(tree.order), tree.grain, tree.buffers
    nodes, children = builder.array((tree.inner, 12), np.float32), builder.array((tree.inner, 2), np.uint32)
    builder.launcher(grain)("encode_bvh2", -(-n // grain.span), b["nodes"], b["turns"], b["ranks"], np.uint32(n), np.uint32(grain.span),
                            nodes.buffer, children.buffer)
    return Encoded(tree.order, builder.gather(grain, tree.order, records), {"nodes": nodes, "children": children})


def _bvh8(builder: DeviceBuilder, tree: DeviceTree, records: DeviceArray) -> Encoded:
    """As ``Bvh8.encode``, but for the order of nodes and blocks."""
    n, grain, b = len(tree.order), tree.grain, tree.buffers
    launch, count, span, items = builder.launcher(grain), np.uint32(n), np.uint32(grain.span), -(-n // grain.span)
    shares, wide_ranks, wides = _collapse(builder, tree)
    nodes = builder.array((wides, WIDTH, 8), np.uint32)
    launch("encode_bvh8", items, b["nodes"], b["ranks"], wide_ranks, shares, count, span, nodes.buffer)
    blocks = builder.array((tree.inner + 1, 10, WIDTH), np.float32)
    ordered = builder.gather(grain, tree.order, records)
    launch("blocks", items, ordered.buffer, b["ranks"], count, span, blocks.buffer)
    return Encoded(tree.order, ordered, {"nodes": nodes, "blocks": blocks})


def _cwbvh(builder: DeviceBuilder, tree: DeviceTree, records: DeviceArray) -> Encoded:
    """As ``Cwbvh.build`` and ``Cwbvh.encode``, but for the order of nodes, and in single precision."""
    n, grain, b = len(tree.order), tree.grain, tree.buffers
    launch, rows = builder.launcher(grain), np.uint32(grain.rows)
    shares, wide_ranks, wides = _collapse(builder, tree)
    slots, numbers = builder.allocate(4 * WIDTH * wides), builder.allocate(4 * wides, 0)
    inner, leaves = builder.allocate(4 * wides), builder.allocate(4 * wides)
    launch("arrange_cwbvh", -(-n // grain.rows), b["nodes"], wide_ranks, shares, np.uint32(n), rows, slots, inner, leaves)
    builder.rank(inner, wides, grain)
    builder.rank(leaves, wides, grain)
    items, order, nodes = -(-wides // grain.rows), builder.array(n, np.uint32), builder.array((wides, 20), np.uint32)
    launch("number_cwbvh", items, b["nodes"], wide_ranks, slots, inner, np.uint32(wides), rows, numbers)
    launch("encode_cwbvh", items, b["nodes"], slots, inner, leaves, numbers, tree.order.buffer, np.uint32(wides), rows, nodes.buffer, order.buffer)
    return Encoded(order, builder.gather(grain, order, records), {"nodes": nodes})


def _collapse(builder: DeviceBuilder, tree: DeviceTree) -> tuple[Any, Any, int]:
    """By pair of nodes, how its children share what they may stand for (``cl/accel/build/shares.cl``), and how many wide nodes begin with it or one before;
    and how many wide nodes there are. As ``lumiere.accel.collapse.collapse``."""
    n, grain, b = len(tree.order), tree.grain, tree.buffers
    launch, roots = builder.launcher(grain), np.uint32(tree.subtrees)
    shares, wide = builder.allocate(4 * n), builder.allocate(4 * n, 0)
    launch("weigh_subtrees", tree.subtrees, b["subtrees"], roots, b["nodes"], b["kept"], shares)
    for level, count in reversed(list(enumerate(tree.large))):
        launch("weigh_level", count, b["counters"], np.uint32(level), b["planes"], b["nodes"], b["kept"], shares)
    for level, count in enumerate(tree.large):
        launch("widen_level", count, b["counters"], np.uint32(level), b["planes"], b["nodes"], b["kept"], shares, wide)
    of_root = np.uint32(0 if tree.large else 1)
    launch("widen_subtrees", tree.subtrees, b["subtrees"], roots, of_root, b["nodes"], b["kept"], shares, wide)
    return shares, wide, builder.rank(wide, n, grain)
