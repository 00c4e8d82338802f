"""How much a device is given at once."""

from __future__ import annotations

from types import SimpleNamespace

import pyopencl as cl
import pytest

from lumiere.wavefront.policy import SLOTS_A_CORE, policy_for


@pytest.mark.parametrize(("cores", "slots", "batch"), [(1, 1 << 14, 1 << 22), (2, 1 << 15, 1 << 22), (16, 1 << 18, 1 << 24), (256, 1 << 20, 1 << 26)])
def test_a_cpu_has_paths_in_flight_for_each_of_its_cores(cores: int, slots: int, batch: int) -> None:
    device = SimpleNamespace(type=cl.device_type.CPU, max_compute_units=cores, max_work_group_size=4096, global_mem_size=1 << 36, max_mem_alloc_size=1 << 34)
    policy = policy_for(device, 1 << 30, 120, 12)
    assert (policy.slots, policy.batch, policy.fill) == (slots, batch, 2 * slots)
    assert policy.slots % policy.work_group == 0 and SLOTS_A_CORE % policy.work_group == 0
    small = policy_for(device, 1000, 120, 12)
    assert (small.slots, small.batch) == (1024, 1000)  # no more than there are samples, in whole groups
