"""What a render does otherwise than its device's policy says: for measurements and diagnosis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from lumiere.accel import Accelerator, choose


@dataclass(frozen=True)
class Overrides:
    """``accelerator`` chooses as ``lumiere.accel.choose`` does; ``compiler_options`` are given to every program's build;
    ``slots``, where set, is the number of paths in flight, and ``compacted`` says how queues are kept.
    """

    accelerator: Callable[[str, int, bool, bool], Accelerator] = choose
    compiler_options: tuple[str, ...] = ()
    slots: int | None = None
    compacted: bool | None = None
