"""One render: a scene, a device, and the batches from the first sample to the picture."""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

import lumiere
from lumiere.accel import choose as choose_accelerator
from lumiere.compile.features import AOV_CHANNELS
from lumiere.compile.scene import compile_scene
from lumiere.film.image import Image
from lumiere.film.progress import Progress
from lumiere.goal.adaptive import render_adaptive
from lumiere.goal.error import LUMINANCE
from lumiere.goal.uniform import Outcome, render_uniform
from lumiere.overrides import Overrides
from lumiere.scene.model import Scene
from lumiere.wavefront.batch import Batch, passes, pixel_order
from lumiere.wavefront.lanes import LANES
from lumiere.wavefront.loop import Wavefront
from lumiere.wavefront.policy import group_size, is_gpu, policy_for
from lumiere.wavefront.state import words_per_path

MOST_SAMPLES = 1 << 20
"""Samples of a pixel, where a render to a goal is given no limit."""

SECONDS_A_BATCH = 1.0
"""How long a batch may take where somebody may want the picture before the last."""


class Render:
    """A render from scene to Image; with ``profiling`` its events tell times. Raises DeviceError where the device cannot do it."""

    def __init__(self, scene: Scene, device: str | int | None = None, load_seconds: float = 0.0,
                 overrides: Overrides | None = None, profiling: bool = False) -> None:
        import pyopencl as cl

        from lumiere.accel.on_device import on_device
        from lumiere.device.select import choose

        overrides = overrides or Overrides()
        self.scene = scene
        self.seconds = {"load": load_seconds, "accelerator": 0.0, "compile": 0.0, "render": 0.0}
        self.device = choose(device)
        begin = time.perf_counter()
        context = cl.Context([self.device])
        properties = cl.command_queue_properties.PROFILING_ENABLE if profiling else 0
        queue = cl.CommandQueue(context, self.device, properties)
        whole_lanes = not is_gpu(self.device) and group_size(self.device) % LANES == 0
        packets = whole_lanes and not overrides.compacted and overrides.accelerator is choose_accelerator
        chooser = on_device(overrides.accelerator, context, queue, overrides.build_on_device)
        buffers = compile_scene(scene, wide=not is_gpu(self.device), packets=packets, choose_accelerator=chooser)
        buffers.features = replace(buffers.features, traced=overrides.traced)
        accelerator = buffers.seconds.get("accelerator", 0.0)
        self.seconds["load"] += time.perf_counter() - begin - accelerator
        self.seconds["accelerator"] = accelerator
        begin = time.perf_counter()
        x0, y0, x1, y1 = scene.film.window
        self.width, self.height = x1 - x0, y1 - y0
        adaptive = scene.sampler.adaptive
        self.samples = self.width * self.height * (scene.sampler.spp if adaptive is None else adaptive.max_spp)
        bytes_per_path = 4 * sum(words_per_path(buffers.features))
        policy = policy_for(self.device, self.samples, bytes_per_path, 4 * buffers.features.channel_count())
        if overrides.slots is not None:
            policy = replace(policy, slots=-(-overrides.slots // policy.work_group) * policy.work_group)
        if overrides.compacted is not None:
            policy = replace(policy, compacted=overrides.compacted)
        self.wavefront = Wavefront(buffers, policy, context, queue, self.width * self.height, compiler_options=overrides.options_of)
        self.seconds["compile"] = time.perf_counter() - begin
        self.counts = np.zeros(self.width * self.height, dtype=np.int64)
        """Samples that each pixel, in device order, has got."""
        self.target = 0.0
        self.outcome: Outcome | None = None
        """Of a render to a goal."""

    def restart(self, seed: int) -> None:
        """Forgets the samples; those that come next are another seed's."""
        self.scene = replace(self.scene, sampler=replace(self.scene.sampler, seed=seed))
        self.wavefront.restart(seed)
        self.counts[:] = 0
        self.outcome = None
        self.seconds["render"] = 0.0

    def run(self, *, time_limit: float | None = None, progress: Callable[[Progress], None] | None = None,
            stop: Callable[[], bool] | None = None, target_error: float | None = None, spp_limit: int = MOST_SAMPLES) -> None:
        """Renders the scene's samples, or as many whole passes as ``time_limit`` and ``stop`` leave.

        With ``target_error``, or where the scene samples adaptively, samples are taken until the picture's relative error is below it;
        ``spp_limit`` is then the most that a pixel gets.
        """
        begin = time.perf_counter()
        adaptive = self.scene.sampler.adaptive
        if adaptive is not None or target_error is not None:
            def keep_on(expected: int) -> bool:
                elapsed = time.perf_counter() - begin
                if progress is not None:
                    progress(Progress(int(self.counts.sum()), expected, elapsed))
                return not ((stop is not None and stop()) or (time_limit is not None and elapsed >= time_limit))

            self.target = target_error or adaptive.target_error
            if adaptive is not None:
                self.outcome = render_adaptive(self, self.target, min(spp_limit, adaptive.max_spp), keep_on)
            else:
                self.outcome = render_uniform(self, self.target, spp_limit, keep_on)
            self.wavefront.finish()
            self.seconds["render"] += time.perf_counter() - begin
            return
        for batch in self._batches(begin, time_limit, patient=time_limit is None and stop is None):
            self.take(batch)
            elapsed = time.perf_counter() - begin
            if progress is not None:
                progress(Progress(int(self.counts.sum()), self.samples, elapsed))
            if self.counts.min() > 0 and ((stop is not None and stop()) or (time_limit is not None and elapsed >= time_limit)):
                break
        self.wavefront.finish()
        self.seconds["render"] += time.perf_counter() - begin

    def _batches(self, begin: float, time_limit: float | None, *, patient: bool) -> Iterator[Batch]:
        """Batches to the last sample: as large as they may be where nobody waits, else first small and then by what the last ones took."""
        pixels, done, spp = self.width * self.height, 0, self.scene.sampler.spp
        at_once = spp if patient else 1
        while done < spp:
            wanted = min(at_once, spp - done)
            yield from passes(done, wanted, pixels, self.wavefront.policy.batch)
            done += wanted
            self.wavefront.finish()
            elapsed = time.perf_counter() - begin
            left = SECONDS_A_BATCH if time_limit is None else min(SECONDS_A_BATCH, max(0.0, time_limit - elapsed))
            at_once = max(1, min(4 * at_once, int(done * left / elapsed)))

    def take(self, batch: Batch) -> None:
        """Renders a batch into the film."""
        self.wavefront.render(batch)
        batch.count_into(self.counts)

    def luminance_sums(self) -> np.ndarray:
        """(pixels,) float64 in device order: luminance of the samples taken so far, summed."""
        return self.luminance_sums_and_deviations()[0]

    def luminance_sums_and_deviations(self) -> tuple[np.ndarray, np.ndarray]:
        """The same, and an upper bound of the standard deviation of a sample's luminance: that of channels that go together."""
        rows = self.wavefront.film(self.width, self.height)
        order = pixel_order(self.width, self.height)
        deviations = np.sqrt(np.maximum(rows[-3:].reshape(3, -1), 0.0))
        return (LUMINANCE @ rows[:3].reshape(3, -1))[order], (LUMINANCE @ deviations)[order] / np.sqrt(np.maximum(self.counts - 1.0, 1.0))

    def image(self, options: dict[str, Any]) -> Image:
        """The picture as it stands. ``options`` are what the call asked for, for the record, which has the scene's own for the others."""
        features, film = self.wavefront.buffers.features, self.scene.film
        rows = self.wavefront.film(self.width, self.height)
        counts = np.zeros(self.width * self.height)
        counts[pixel_order(self.width, self.height)] = self.counts
        n = counts.reshape(self.height, self.width)
        means = rows / np.maximum(n, 1.0)
        pixels = np.moveaxis(means[:3], 0, -1).astype(np.float32)
        # Deviations are summed in float32: where all samples are equal they may come out a rounding below 0.
        variance = np.maximum(np.moveaxis(means[-3:], 0, -1), 0.0) / np.maximum(n - 1.0, 1.0)[..., None]
        variance = np.where((n > 1.0)[..., None], variance, np.inf).astype(np.float32)
        aovs = {}
        for name in film.aovs:
            if name == "variance":
                aovs[name] = variance
            elif name == "sample_count":
                aovs[name] = n.astype(np.float32)
            else:
                first, size = features.channels()[name], AOV_CHANNELS[name]
                layer = rows[first] - 1.0 if name.endswith("_id") else np.moveaxis(means[first:first + size], 0, -1)
                aovs[name] = np.squeeze(layer, axis=-1).astype(np.float32) if layer.ndim == 3 and size == 1 else layer.astype(np.float32)
        if self.outcome is not None and self.outcome.error is not None:
            layer = np.zeros(self.width * self.height, dtype=np.float32)
            layer[pixel_order(self.width, self.height)] = self.outcome.error.pixels
            aovs["error"] = layer.reshape(self.height, self.width)
        image = Image(pixels=pixels, variance=variance, aovs=aovs, record=self._record(options), crop=film.window,
                      full_size=(film.width, film.height))
        return image

    def _record(self, options: dict[str, Any]) -> dict[str, Any]:
        wavefront, scene = self.wavefront, self.scene
        count, places = wavefront.non_finite(self.width, self.height)
        x0, y0, _, _ = scene.film.window
        samples = int(self.counts.sum())
        seconds = {name: round(value, 4) for name, value in self.seconds.items()}
        options = {"spp": scene.sampler.spp if self.outcome is None else None, "seed": scene.sampler.seed, "width": scene.film.width,
                   "height": scene.film.height, "crop": scene.film.crop, "max_depth": scene.integrator.max_depth, "device": None,
                   "time_limit": None, "target_error": None} | options
        return {
            "scene": str(scene.path) if scene.path else None, "scene_hash": scene.text_hash, "version": lumiere.__version__,
            "device": self.device.name.strip(), "driver": f"{self.device.platform.name} {self.device.driver_version}", "options": options,
            "spp": int(self.counts.min()), "seed": scene.sampler.seed, "features": wavefront.buffers.features.as_record(),
            "bias": {} if scene.integrator.clamp_indirect is None else {"clamp_indirect": scene.integrator.clamp_indirect},
            **self._error_record(),
            "kernels": [{"name": b.name, "reason": b.reason, "seconds": round(b.seconds, 4)} for b in wavefront.builds],
            "bytes_per_path": wavefront.bytes_per_path, "paths_in_flight": wavefront.policy.slots,
            "seconds": seconds | {"total": round(sum(self.seconds.values()), 4)},
            "samples_per_second": samples / self.seconds["render"] if self.seconds["render"] > 0.0 else 0.0,
            "rays": {"nearest": wavefront.rays.nearest, "shadow": wavefront.rays.shadow},
            "triangles_dropped": wavefront.buffers.dropped,
            "memory": {"host_peak": _host_peak(), "device_peak": wavefront.memory.bytes},
            "non_finite": {"count": count, "samples": [place | {"x": place["x"] + x0, "y": place["y"] + y0} for place in places]},
        }


    def _error_record(self) -> dict[str, Any]:
        """What a render to a goal came to."""
        if self.outcome is None:
            return {}
        error = self.outcome.error
        told = {} if error is None else {"image": error.image, "bound": error.bound, "pixels_above": float((error.pixels > self.target).mean())}
        return {"error": {"target": self.target, "reached": self.outcome.reached, **told}, "mean_spp": float(self.counts.mean())}


def _host_peak() -> int:
    """Peak resident memory of this process, bytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024
