"""Runs functions of the device code as the renderer builds them: a kernel of the test's own behind the text of a stage's program."""

from __future__ import annotations

import warnings
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pyopencl as cl

from lumiere.compile.scene import SceneBuffers, compile_scene
from lumiere.scene.load import load
from lumiere.wavefront.batch import Batch
from lumiere.wavefront.policy import policy_for
from lumiere.wavefront.source import program_sources
from tests.contexts import context_of

Array = np.ndarray

KERNEL = """

kernel void probe(STAGE_PARAMETERS, uint probe_count, global const float *in_floats, global const uint *in_uints, global float *out_floats,
                  global uint *out_uints)
{
    STAGE_BEGIN
    uint item = (uint)get_global_id(0);
    if (item >= probe_count)
        return;
"""


@cache
def _build(device: cl.Device, text: str) -> tuple[cl.Context, cl.CommandQueue, cl.Kernel]:
    context = context_of(device)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cl.CompilerWarning)
        # Not from pyopencl's cache: Intel's runtime knows no arguments of a program that was built before.
        program = cl.Program(context, text).build(["-cl-kernel-arg-info"], cache_dir=False)
    return context, cl.CommandQueue(context), cl.Kernel(program, "probe")


class Probe:
    """A kernel over a scene (a dict, as ``lumiere.load`` takes it), in which ``body`` runs once for each item.

    ``body`` sees ``scene``, ``item``, ``in_floats`` and ``in_uints``, and writes ``out_floats`` and ``out_uints``. It may call whatever the
    program of ``stage`` holds: its own file's functions and all that it includes; ``alone``: of the form for one path, though there is one for sixteen.
    """

    def __init__(self, device: cl.Device, scene: dict[str, Any], stage: str, body: str, *, functions: str = "", alone: bool = False) -> None:
        self.buffers: SceneBuffers = compile_scene(load(scene))
        policy = policy_for(device, 64, 256, 64)
        sources = program_sources(self.buffers, replace(policy, compacted=policy.compacted or alone))
        text = next(source.text for source in sources if source.name.startswith(stage))
        self.context, self.queue, self.kernel = _build(device, f"{text}\n{functions}\n{KERNEL}{body}\n}}\n")

    def _buffer(self, array: Array) -> cl.Buffer:
        array = np.ascontiguousarray(array) if array.size else np.zeros(1, np.uint32)
        return cl.Buffer(self.context, cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR, hostbuf=array)

    def __call__(self, count: int, *, floats: Array | None = None, uints: Array | None = None, out_floats: int = 0, out_uints: int = 0,
                 batch: Batch | None = None) -> tuple[Array, Array]:
        """Runs ``count`` items. Returns (count, out_floats) float32 and (count, out_uints) uint32."""
        batch = batch or Batch(0, count, 1, 0)
        results = np.zeros((count, out_floats), np.float32), np.zeros((count, out_uints), np.uint32)
        outputs = [self._buffer(result) for result in results]
        given: dict[str, Any] = {
            "probe_count": np.uint32(count), "batch": self._buffer(batch.record()), "out_floats": outputs[0], "out_uints": outputs[1],
            "in_floats": self._buffer(np.zeros(0) if floats is None else np.asarray(floats, np.float32)),
            "in_uints": self._buffer(np.zeros(0) if uints is None else np.asarray(uints, np.uint32))}
        given |= {f"scene_{name}": self._buffer(array) for name, (_, array) in self.buffers.arrays.items()}
        for number in range(self.kernel.num_args):
            name = self.kernel.get_arg_info(number, cl.kernel_arg_info.NAME)
            pointer = self.kernel.get_arg_info(number, cl.kernel_arg_info.TYPE_NAME).endswith("*")
            if name not in given:  # the stage's own: strides that all items fit in, and room for 64 words of each
                given[name] = self._buffer(np.zeros(64 * max(count, 64), np.uint32)) if pointer else np.uint32(0 if name == "parity" else count)
            self.kernel.set_arg(number, given[name])  # which keeps no reference: ``given`` does
        cl.enqueue_nd_range_kernel(self.queue, self.kernel, (-(-count // 64) * 64,), (64,))
        self.queue.finish()
        for result, output in zip(results, outputs, strict=True):
            if result.size:
                cl.enqueue_copy(self.queue, result, output)
        return results
