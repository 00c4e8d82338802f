"""How far the render is, for whoever waits: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import shutil
from typing import TextIO

from lumiere.cli.values import clock, with_prefix
from lumiere.film.progress import Progress

SECONDS_A_LINE = 5.0
"""Least time between two plain lines."""

SECONDS_A_FRAME = 0.1
"""Least time between two states of the bar."""


class ProgressDisplay:
    """Shows each Progress that it is called with on ``stream``."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream
        self.terminal = stream.isatty()
        self.started = False
        """A first batch is done, so there is a picture."""
        self._shown = 0.0
        self._drawn = 0

    def __call__(self, progress: Progress) -> None:
        self.started = True
        pause = SECONDS_A_FRAME if self.terminal else SECONDS_A_LINE
        if progress.seconds - self._shown < pause and not (self.terminal and progress.fraction == 1.0):
            return
        self._shown = progress.seconds
        if self.terminal:
            self._draw(progress)
        else:
            self.stream.write(f"lumiere: {_words(progress)}\n")
        self.stream.flush()

    def close(self) -> None:
        """Ends the bar's line, if there is one."""
        if self._drawn:
            self.stream.write("\n")
            self.stream.flush()
            self._drawn = 0

    def _draw(self, progress: Progress) -> None:
        columns = shutil.get_terminal_size().columns - 1
        words = _words(progress)
        room = min(40, columns - len(words) - 4)
        line = words
        if room >= 5:
            filled = int(progress.fraction * room)
            line = f"[{'#' * filled}{' ' * (room - filled)}] {words}"
        line = line[:columns]
        self.stream.write(f"\r{line.ljust(self._drawn)}")
        self._drawn = len(line)


def _words(progress: Progress) -> str:
    left = progress.seconds_left
    remaining = f", {clock(left)} left" if left is not None and progress.fraction < 1.0 else ""
    return f"{progress.fraction * 100.0:3.0f} %, {with_prefix(progress.samples_per_second, 'samples/s')}{remaining}"
