"""What suits a device: how queues are kept, how many paths are in flight, how large a batch is. The figures: docs/performance.md."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

SLOTS_A_CORE = 1 << 14
"""Paths in flight for each core of a CPU: with fewer, cores wait for each other at the end of every launch."""


@dataclass(frozen=True)
class Policy:
    """``compacted``: queues are lists of slots (GPUs), else tags on all slots (CPUs). ``slots``: paths in flight; ``batch``: samples in one batch;
    ``rounds``: rounds of stages queued between two looks at the counters, even; ``groups_leave``: work-groups beyond a queue's end return at once;
    ``fill``: samples below which a batch leaves the device half idle."""

    compacted: bool
    work_group: int
    slots: int
    batch: int
    rounds: int
    groups_leave: bool = False
    fill: int = 1 << 16


def is_gpu(device: Any) -> bool:
    """A device that runs work-items in lockstep: it wants compacted queues and one ray a lane."""
    import pyopencl as cl

    return bool(device.type & (cl.device_type.GPU | cl.device_type.ACCELERATOR))


def group_size(device: Any) -> int:
    """Slots that a work-group works on."""
    return min(256, device.max_work_group_size)


def policy_for(device: Any, samples: int, bytes_per_path: int, bytes_per_sample: int) -> Policy:
    """The policy for ``device`` (a pyopencl.Device) to render ``samples`` samples: no more slots than samples, no more memory than a quarter."""
    gpu = is_gpu(device)
    work_group = group_size(device)
    memory = min(device.global_mem_size // 4, device.max_mem_alloc_size)
    most = 1 << 26 if gpu else min(device.max_compute_units * SLOTS_A_CORE, 1 << 20)
    slots = min(most, memory // 2 // max(1, bytes_per_path), max(1, samples))
    batch = min(1 << 26 if gpu else max(1 << 22, 64 * most), memory // max(1, bytes_per_sample), max(1, samples))
    return Policy(gpu, work_group, -(-slots // work_group) * work_group, batch, 2 if gpu else 8, groups_leave=gpu, fill=1 << 24 if gpu else 2 * most)
