"""Ending early, with the picture that is there."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any

INTERRUPTED = 130
"""Exit status after SIGINT or SIGTERM: 128 + SIGINT, as shells have it."""

NOTHING_WRITTEN = "lumiere: interrupted; nothing written\n"


class StopOnSignal:
    """Within the block SIGINT and SIGTERM ask the render to stop between batches: it is the render's ``stop``.

    Where ``nothing_yet`` says that there is no picture they end the process; the second signal interrupts at once (KeyboardInterrupt).
    """

    def __init__(self, nothing_yet: Callable[[], bool]) -> None:
        self.nothing_yet = nothing_yet
        self.asked = False
        self._before: dict[int, Any] = {}

    def __call__(self) -> bool:
        return self.asked

    def __enter__(self) -> StopOnSignal:
        for number in (signal.SIGINT, signal.SIGTERM):
            self._before[number] = signal.signal(number, self._receive)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _receive(self, number: int, frame: FrameType | None) -> None:
        if self.nothing_yet():
            # An exception might meet a driver or a module that is being loaded, which abort, and would wait for the programs that are being built.
            os.write(2, NOTHING_WRITTEN.encode())
            os._exit(INTERRUPTED)
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True
