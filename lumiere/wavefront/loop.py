"""The wavefront: rounds of generate → extend → escape, scatter, shade → connect until a batch is done, then accumulate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from lumiere.compile.scene import SceneBuffers
from lumiere.device.program import Build, build_all
from lumiere.overrides import Overrides
from lumiere.wavefront.batch import BATCH, Batch, pixel_order
from lumiere.wavefront.memory import DeviceMemory
from lumiere.wavefront.policy import Policy
from lumiere.wavefront.source import COUNTERS, NON_FINITE_KEPT, TRACING, VISIT_BOUNCES, VISIT_COPIES, counter_count, program_sources, queue_names
from lumiere.wavefront.state import words_per_path


@dataclass
class RayCounts:
    """Rays traced so far, by kind."""

    nearest: int = 0
    shadow: int = 0


@dataclass
class Wavefront:
    """A scene on a device, ready to render batches into its film. ``pixels`` is the number of the crop's pixels."""

    buffers: SceneBuffers
    policy: Policy
    context: Any
    queue: Any
    pixels: int
    builds: list[Build] = field(default_factory=list)
    rays: RayCounts = field(default_factory=RayCounts)
    observer: Callable[[str, int, Any], None] | None = None
    """Told each launch's stage, round and event; the queue must then have been made with profiling."""
    compiler_options: Callable[[str], tuple[str, ...]] = Overrides().options_of
    """Of a stage's programs, by the stage's name."""
    slots: int = 0
    """That the last launch looked at."""

    def __post_init__(self) -> None:
        features, policy = self.buffers.features, self.policy
        self.memory = DeviceMemory(self.context, self.queue)
        self.queues = queue_names(features)
        floats, uints = words_per_path(features)
        # Arrays whose distance is a power of two share cache sets: 16 words more.
        stride, self.sample_stride, self.film_stride = policy.slots + 16, policy.batch + 16, self.pixels + 16
        self.film_arrays = 2 * features.channel_count() + 3
        allocate = self.memory.allocate
        self._scene = [self.memory.upload(f"the scene's {name}", array) for name, (_, array) in self.buffers.arrays.items()]
        path_floats, path_uints = allocate("path state", 4 * floats * stride), allocate("path state", 4 * uints * stride)
        self._queue_slots = allocate("queues", 4 * policy.slots * (len(self.queues) if policy.compacted else 2))
        self._counters = allocate("counters", 4 * counter_count(features))
        self._samples = allocate("the sample buffer", 4 * features.channel_count() * self.sample_stride)
        self._film = allocate("the film", 4 * self.film_arrays * self.film_stride)
        self._non_finite = allocate("the list of non-finite samples", 4 * (1 + 2 * NON_FINITE_KEPT))
        self._batch = allocate("the batch", BATCH.itemsize)
        self._arguments = [path_floats, path_uints, np.uint32(stride), self._queue_slots, self._counters, np.uint32(policy.slots)]
        self._visits: dict[str, Any] = {}
        self._build()

    def _build(self) -> None:
        """The programs and their kernels; those that count visits where there are counts for them."""
        import pyopencl as cl

        sources = program_sources(self.buffers, self.policy, counting=bool(self._visits))
        sources = [replace(source, options=self.compiler_options(source.name.partition("[")[0])) for source in sources]
        self.builds = build_all(sources, self.context, self.queue.device)
        self._rounds = [[self._stage(build, parity) for build in self.builds[:-1]] for parity in (0, 1)]
        self._accumulate = self._accumulate_kernel(self.builds[-1])
        # A group does work_group slots, by as many work-items or by one for several (cl/lib/lanes.cl).
        self._group_sizes = [kernel.get_work_group_info(cl.kernel_work_group_info.COMPILE_WORK_GROUP_SIZE, self.queue.device)[0]
                             for kernel in self._rounds[0]]

    def count_visits(self) -> None:
        """From now on ``visits`` tells what rays have visited; the stages that trace are slower for it."""
        self._visits = {stage: self.memory.allocate("counts of visits", 4 * VISIT_COPIES * VISIT_BOUNCES * 6) for stage in TRACING}
        self._build()

    def visits(self, stage: str) -> np.ndarray:
        """(VISIT_BOUNCES, 3) uint64: rays that the stage has traced since ``count_visits``, nodes and primitives that these have visited, by bounce."""
        import pyopencl as cl

        words = np.zeros((VISIT_COPIES, VISIT_BOUNCES, 3, 2), dtype="<u4")
        cl.enqueue_copy(self.queue, words, self._visits[stage], is_blocking=True)
        return words.view("<u8")[..., 0].sum(axis=0)

    @property
    def bytes_per_path(self) -> int:
        """Path state and queue entries of one path."""
        return 4 * sum(words_per_path(self.buffers.features)) + 4 * (len(self.queues) if self.policy.compacted else 2)

    def _stage(self, build: Build, parity: int) -> Any:
        import pyopencl as cl

        kernel = cl.Kernel(build.program, build.name.partition("[")[0])
        counts = [self._visits[build.name]] if build.name in self._visits else []
        kernel.set_args(*self._arguments, np.uint32(parity), self._samples, np.uint32(self.sample_stride), self._batch, *self._scene, *counts)
        return kernel

    def _accumulate_kernel(self, build: Build) -> Any:
        import pyopencl as cl

        kernel = cl.Kernel(build.program, "accumulate")
        listed = [self._array("pixel_list")] if self.buffers.features.pixel_list else []
        kernel.set_args(self._samples, np.uint32(self.sample_stride), self._film, np.uint32(self.film_stride), self._non_finite, self._batch,
                        *listed)
        return kernel

    def _array(self, name: str) -> Any:
        """The device's buffer of one of the scene's arrays."""
        return self._scene[list(self.buffers.arrays).index(name)]

    def restart(self, seed: int) -> None:
        """An empty film, whose samples come from another seed."""
        import pyopencl as cl

        _, record = self.buffers.arrays["render"]
        record["seed"] = seed
        cl.enqueue_copy(self.queue, self._array("render"), record, is_blocking=True)
        for buffer in (self._film, self._non_finite):
            cl.enqueue_fill_buffer(self.queue, buffer, np.uint32(0), 0, buffer.size)

    def _begin(self, batch: Batch) -> None:
        """All slots idle, all counters 0."""
        import pyopencl as cl

        counters = np.zeros(counter_count(self.buffers.features), dtype=np.uint32)
        if self.policy.compacted:
            counters[self.queues.index("IDLE_0")] = self.policy.slots
            counters[len(self.queues) + COUNTERS.index("FIRST_ROUND")] = 1
        else:
            cl.enqueue_fill_buffer(self.queue, self._queue_slots, np.uint32(0), 0, 8 * self.policy.slots)
        cl.enqueue_copy(self.queue, self._counters, counters, is_blocking=True)
        cl.enqueue_copy(self.queue, self._batch, batch.record(), is_blocking=True)
        if self.buffers.features.pixel_list:
            cl.enqueue_copy(self.queue, self._array("pixel_list"), batch.entries, is_blocking=True)

    def render(self, batch: Batch) -> None:
        """Renders a batch and adds it to the film. The host looks at the counters one look behind the device, so neither waits for the other."""
        import pyopencl as cl

        self._begin(batch)
        group, slots = self.policy.work_group, self.policy.slots
        pending: tuple[Any, np.ndarray] | None = None
        done = 0
        while True:
            for number in range(self.policy.rounds):
                for build, kernel, items in zip(self.builds, self._rounds[number % 2], self._group_sizes, strict=False):
                    event = cl.enqueue_nd_range_kernel(self.queue, kernel, (slots // group * items,), (items,))
                    self.slots = slots
                    if self.observer is not None:
                        self.observer(build.name, done + number, event)
            done += self.policy.rounds
            counters = np.zeros(counter_count(self.buffers.features), dtype=np.uint32)
            look = cl.enqueue_copy(self.queue, counters, self._counters, is_blocking=False)
            self.queue.flush()
            if pending is not None:
                pending[0].wait()
                live = int(pending[1][self.queues.index("EXTEND_1")])
                if live == 0:
                    break
                if self.policy.compacted and pending[1][len(self.queues) + COUNTERS.index("NEXT_SAMPLE")] >= batch.sample_count:
                    slots = -(-live // group) * group  # no queue grows any more
            pending = (look, counters)
        pixels = -(-batch.pixel_count // self.policy.work_group) * self.policy.work_group
        event = cl.enqueue_nd_range_kernel(self.queue, self._accumulate, (pixels,), (group,))
        if self.observer is not None:
            self.observer("accumulate", done, event)
        look.wait()
        self.rays.nearest += int(counters[len(self.queues) + COUNTERS.index("RAYS")])
        self.rays.shadow += int(counters[len(self.queues) + COUNTERS.index("SHADOW_RAYS")])

    def census(self) -> dict[str, int]:
        """Slots in each queue and the counters, by name, as they stand when all that was launched is done; for observers, since it waits."""
        import pyopencl as cl

        counters = np.zeros(counter_count(self.buffers.features), dtype=np.uint32)
        cl.enqueue_copy(self.queue, counters, self._counters, is_blocking=True)
        found = dict(zip([*self.queues, *COUNTERS], counters.tolist(), strict=True))
        if not self.policy.compacted:
            slots = np.zeros((2, self.policy.slots), dtype=np.uint32)
            cl.enqueue_copy(self.queue, slots, self._queue_slots, is_blocking=True)
            found |= zip(self.queues, np.bincount(slots[0], minlength=len(self.queues)).tolist(), strict=True)
            found["CONNECT"] = int(np.count_nonzero(slots[1]))
        return found

    def snapshot(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """For diagnosis, with queues that are not compacted and one sample in flight: path state of floats and of unsigned integers, (words, slots);
        the slots' tags and whether they want connect; the first sample's radiance, float64.
        """
        import pyopencl as cl

        floats, uints = words_per_path(self.buffers.features)
        slots, stride = self.policy.slots, int(self._arguments[2])
        arrays = (np.zeros((floats, stride), np.float32), np.zeros((uints, stride), np.uint32), np.zeros(2 * slots, np.uint32))
        for array, buffer in zip(arrays, (self._arguments[0], self._arguments[1], self._queue_slots), strict=True):
            cl.enqueue_copy(self.queue, array, buffer, is_blocking=True)
        return (*arrays[:2], arrays[2][:slots], arrays[2][slots:], self.sample_values()[:3, 0].astype(np.float64))

    def sample_values(self) -> np.ndarray:
        """(channels, samples) float32 of the sample buffer: what the last batch's samples gathered, if it is done."""
        import pyopencl as cl

        values = np.zeros((self.buffers.features.channel_count(), self.sample_stride), np.float32)
        cl.enqueue_copy(self.queue, values, self._samples, is_blocking=True)
        return values

    def finish(self) -> None:
        """Waits for the device."""
        self.queue.finish()

    def film(self, width: int, height: int) -> np.ndarray:
        """(arrays, height, width) float64 of the film as it stands: for each channel its sum, then the squared deviations of radiance."""
        import pyopencl as cl

        channels = self.buffers.features.channel_count()
        raw = np.zeros(self.film_arrays * self.film_stride, dtype=np.float32)
        cl.enqueue_copy(self.queue, raw, self._film, is_blocking=True)
        rows, order = raw.reshape(self.film_arrays, self.film_stride)[:, :self.pixels], pixel_order(width, height)
        out = np.zeros((channels + 3, self.pixels))
        for channel in range(channels):  # a compensated sum less what it still owes
            out[channel, order] = np.subtract(rows[2 * channel], rows[2 * channel + 1], dtype=np.float64)
        for channel in range(channels, channels + 3):
            out[channel, order] = rows[channels + channel]
        return out.reshape(channels + 3, height, width)

    def non_finite(self, width: int, height: int) -> tuple[int, list[dict[str, int]]]:
        """How many samples were not finite, and where the first of them are: pixel in the crop and sample index."""
        import pyopencl as cl

        raw = np.zeros(1 + 2 * NON_FINITE_KEPT, dtype=np.uint32)
        cl.enqueue_copy(self.queue, raw, self._non_finite, is_blocking=True)
        order = pixel_order(width, height)
        kept = raw[1:1 + 2 * min(int(raw[0]), NON_FINITE_KEPT)].reshape(-1, 2)
        places = sorted({(int(order[pixel]), int(sample)) for pixel, sample in kept})
        return int(raw[0]), [{"x": at % width, "y": at // width, "sample": sample} for at, sample in places]
