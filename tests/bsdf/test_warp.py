"""Warps carry uniform points of the unit square to the density that they state."""

from __future__ import annotations

import warnings

import numpy as np
import pyopencl as cl
import pytest

from lumiere.device.source import assemble
from tests.bsdf.harness import uniform
from tests.contexts import context_of
from tests.statistics import chi_square, sidak

SAMPLES = 1 << 20

KERNEL = """
kernel void warp(global const float *u, global float *out)
{
    const uint i = get_global_id(0);
    vstore3(WARP(vload2(i, u)), i, out);
}
"""

WARPS = {
    "square_to_disk": ("(float3)(square_to_disk(u), 0.0f)", lambda p: p[:, 0] ** 2 + p[:, 1] ** 2),
    "square_to_cosine_hemisphere": ("square_to_cosine_hemisphere(u)", lambda p: p[:, 0] ** 2 + p[:, 1] ** 2),
    "square_to_hemisphere": ("square_to_hemisphere(u)", lambda p: p[:, 2]),
}
"""Name → call, and what is uniform in [0, 1] besides the azimuth, which is in [−π, π]."""


@pytest.mark.parametrize("name", WARPS)
def test_warp(device: cl.Device, name: str) -> None:
    call, radial = WARPS[name]
    u = uniform(np.random.default_rng(7), SAMPLES, 2)
    u[:4] = [[0.0, 0.0], [1.0 - 2.0**-24, 1.0 - 2.0**-24], [0.5, 0.5], [0.0, 0.5]]
    context = context_of(device)
    queue = cl.CommandQueue(context)
    text = assemble("lib/warp.cl") + KERNEL.replace("WARP(vload2(i, u))", call.replace("(u", "(vload2(i, u)"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cl.CompilerWarning)
        program = cl.Program(context, text).build()
    points = np.zeros((SAMPLES, 3), np.float32)
    read = cl.Buffer(context, cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR, hostbuf=u)
    written = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, points.nbytes)
    cl.Kernel(program, "warp")(queue, (SAMPLES,), None, read, written)
    cl.enqueue_copy(queue, points, written)
    points = points.astype(np.float64)

    assert np.all(np.isfinite(points))
    length = np.linalg.norm(points, axis=1)
    if name == "square_to_disk":
        assert np.all(length <= 1.0 + 1e-6)
    else:
        assert np.all(np.abs(length - 1.0) < 1e-6) and np.all(points[:, 2] >= 0.0)
    azimuth = np.arctan2(points[:, 1], points[:, 0])
    counts, _, _ = np.histogram2d(np.clip(radial(points), 0.0, 1.0), azimuth, [16, 32], [[0.0, 1.0], [-np.pi, np.pi]])
    assert chi_square(counts.ravel(), np.full(counts.size, SAMPLES / counts.size)) > sidak(1e-3, len(WARPS))
