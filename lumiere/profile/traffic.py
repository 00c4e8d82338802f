"""Bytes: what each stage moves of paths, samples and queues, and how fast the device copies."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import Any

from lumiere.compile.features import Features
from lumiere.wavefront.policy import Policy
from lumiere.wavefront.state import path_fields

COPIED = 256 << 20
"""Bytes of the buffer that is copied: more than caches hold."""

_ACCESS = re.compile(r"\bpath_(get|set)_(\w+?)(?:_lanes)?\((?!const path_t)")
_DIRECTIVE = re.compile(r"\s*#\s*(ifdef|ifndef|if|else|elif|endif|define|undef)\b\s*(\w*)")


@dataclass(frozen=True)
class Traffic:
    """Bytes of path state that a stage reads and writes for one item, and of the sample buffer, both ways together."""

    read: int
    written: int
    samples: int = 0

    @property
    def bytes(self) -> int:
        """All of them."""
        return self.read + self.written + self.samples


def queue_bytes(policy: Policy, stage: str, items: int, given: int, slots: int) -> int:
    """Bytes of queues that launches of a stage move: of lists an entry an item and an entry for each slot that they give to another stage or, as
    they do with what they end, to the idle ones; of tags every slot's, and again those of items. None where it takes from no queue, or gives to none.
    """
    if stage == "accumulate":
        return 0
    if not policy.compacted:
        return 4 * (slots * (2 if stage == "generate" else 1) + (0 if stage == "connect" else items))
    return 4 * (items + given + (0 if stage in ("generate", "connect") else max(0, items - given)))


def active_lines(text: str) -> Iterator[str]:
    """The lines of ``text`` that ``#ifdef`` and ``#ifndef`` leave; what ``#if`` and ``#elif`` ask is taken as true."""
    defined: set[str] = set()
    shown = [True]
    for line in text.splitlines():
        match = _DIRECTIVE.match(line)
        if not match:
            if all(shown):
                yield line
            continue
        word, name = match.groups()
        if word in ("ifdef", "ifndef", "if"):
            shown.append({"ifdef": name in defined, "ifndef": name not in defined, "if": True}[word])
        elif word == "else":
            shown[-1] = not shown[-1]
        elif word == "endif":
            shown.pop()
        elif all(shown) and word == "define":
            defined.add(name)
            yield line
        elif all(shown) and word == "undef":
            defined.discard(name)


def path_traffic(stage: str, text: str, features: Features) -> Traffic:
    """What the program ``text`` of a stage touches of one path: each field that it names counts once for reading and once for writing; and of the
    path's sample, all channels where it begins or ends, else the radiance where the stage may add to it.
    """
    sizes = {field.name: 4 * field.size for field in path_fields(features)}
    touched = {match.groups() for line in active_lines(text) for match in _ACCESS.finditer(line)}
    adds = any("sample_add_radiance(" in line and not line.startswith("static") for line in active_lines(text))
    samples = 4 * features.channel_count() if stage in ("generate", "accumulate") else 24 if adds else 0
    return Traffic(sum(sizes.get(name, 0) for way, name in touched if way == "get"),
                   sum(sizes.get(name, 0) for way, name in touched if way == "set"), samples)


def copy_bandwidth(queue: Any, repeats: int = 5) -> float:
    """Bytes that are read and written a second where one large buffer is copied to another: the median of ``repeats``."""
    import numpy as np
    import pyopencl as cl

    device = queue.device
    size = min(COPIED, device.max_mem_alloc_size, device.global_mem_size // 8) // 4 * 4
    buffers = [cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, size) for _ in range(2)]
    for buffer in buffers:
        cl.enqueue_fill_buffer(queue, buffer, np.uint32(0), 0, size)
    times = []
    for _ in range(repeats + 1):
        queue.finish()
        begin = time.perf_counter()
        cl.enqueue_copy(queue, buffers[1], buffers[0])
        queue.finish()
        times.append(time.perf_counter() - begin)
    for buffer in buffers:
        buffer.release()
    return 2.0 * size / median(times[1:])
