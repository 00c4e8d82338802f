"""Which accelerators are tested on which device."""

from __future__ import annotations

import pytest

from lumiere.wavefront.policy import is_gpu


@pytest.fixture(autouse=True)
def accelerator_for_the_device(request: pytest.FixtureRequest) -> None:
    """Skips the plain eight-wide tree on GPUs, which get it only where asked (lumiere.accel): its claims to the bit hold where divisions round correctly."""
    parameters = request.node.callspec.params if hasattr(request.node, "callspec") else {}
    chosen = parameters.get("accelerator") or parameters.get("tree")
    if chosen is not None and chosen.name == "bvh8" and parameters.get("device") is not None and is_gpu(parameters["device"]):
        pytest.skip("an eight-wide tree is for CPUs")
