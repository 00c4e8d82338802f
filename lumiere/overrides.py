"""What a render does otherwise than its device's policy says: for measurements and diagnosis."""

from __future__ import annotations

from dataclasses import dataclass

from lumiere.accel import Choice, choose


@dataclass(frozen=True)
class Overrides:
    """``accelerator`` chooses as ``lumiere.accel.choose`` does; ``build_on_device``, where set, says whether trees are built on the device or by
    numpy; ``compiler_options`` are given to the build of every program, or of those of the stages named in ``stages``; ``slots``, where set, is the
    number of paths in flight, and ``compacted`` says how queues are kept. ``traced`` paths keep more of what they did.
    """

    accelerator: Choice = choose
    build_on_device: bool | None = None
    compiler_options: tuple[str, ...] = ()
    stages: tuple[str, ...] = ()
    slots: int | None = None
    compacted: bool | None = None
    traced: bool = False

    def options_of(self, stage: str) -> tuple[str, ...]:
        """The compiler's options for the programs of ``stage``."""
        return self.compiler_options if not self.stages or stage in self.stages else ()
