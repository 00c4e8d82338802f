"""Which rays are none, so that they visit no node."""

from __future__ import annotations

import numpy as np
import pyopencl as cl

from tests.accel.test_triangle import run


def test_rays_that_are_none(device: cl.Device) -> None:
    """One coordinate of six is odd; or the direction has no length."""
    odd = np.float32([np.inf, -np.inf, np.nan, 0.0, -0.0, 1e-38, 3e38, -3e38])
    rays = np.tile(np.float32([0.0, 1.0, -2.0, 0.5, -0.5, 1.0]), (6 * len(odd), 1))
    for place in range(6):
        rays[place * len(odd):(place + 1) * len(odd), place] = odd
    along_x = np.zeros((len(odd), 6), np.float32)
    along_x[:, 3] = odd
    rays = np.concatenate([rays, along_x])
    valid = run(device, "0.0f; const ray_t ray = {(float3)(a, b, c), (float3)(d, e, f), 1.0f}; out[i] = ray_is_valid(&ray)", *rays.T)
    expected = np.isfinite(rays).all(axis=1) & rays[:, 3:].any(axis=1)
    assert np.array_equal(valid, expected)
