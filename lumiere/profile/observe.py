"""Observers of the wavefront's launches: one keeps their times, one counts what each finds to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from lumiere.wavefront.loop import Wavefront


@dataclass(frozen=True)
class Launch:
    """One launch of a stage: ``round`` in its ``batch``, ``start`` in seconds since the first launch, ``seconds`` that the device took."""

    stage: str
    batch: int
    round: int
    start: float
    seconds: float

    @property
    def end(self) -> float:
        """Seconds since the first launch."""
        return self.start + self.seconds


def _next_batch(batch: int, stage: str, number: int) -> int:
    """A batch begins with its first round's ``generate``."""
    return batch + 1 if number == 0 and stage == "generate" else batch


@dataclass
class Times:
    """An observer that keeps the events; the queue must have been made with profiling."""

    batch: int = -1
    events: list[tuple[str, int, int, Any]] = field(default_factory=list)
    _read: list[tuple[str, int, int, int, int]] = field(default_factory=list)

    def __call__(self, stage: str, number: int, event: Any) -> None:
        batch = _next_batch(self.batch, stage, number)
        if batch != self.batch:
            self._drain()  # the last batch is all but done, and drivers slow down where many events live
        self.batch = batch
        self.events.append((stage, batch, number, event))

    def _drain(self) -> None:
        for stage, batch, number, event in self.events:
            event.wait()
            self._read.append((stage, batch, number, event.profile.start, event.profile.end))
        self.events.clear()

    def launches(self) -> list[Launch]:
        """All launches, in the order of their starts; waits for the last."""
        self._drain()
        rows = sorted(self._read, key=lambda row: row[3])
        first = rows[0][3] if rows else 0
        return [Launch(stage, batch, number, (start - first) * 1e-9, (end - start) * 1e-9) for stage, batch, number, start, end in rows]


@dataclass
class Items:
    """An observer that counts the items of each launch: the paths or rays that wait for the stage when it starts. It waits for every launch, so
    it is for a run that nobody times.

    ``items[batch, round, stage]``; ``paths[batch, round]`` counts the paths that are alive when the round's new ones have started.
    """

    wavefront: Wavefront
    batch: int = -1
    items: dict[tuple[int, int, str], int] = field(default_factory=dict)
    paths: dict[tuple[int, int], int] = field(default_factory=dict)
    _before: dict[str, int] = field(default_factory=dict)

    def __call__(self, stage: str, number: int, event: Any) -> None:
        batch = _next_batch(self.batch, stage, number)
        if batch != self.batch:
            self.batch, self._before = batch, {}
        alive = f"EXTEND_{number % 2}" if self.wavefront.policy.compacted else "EXTEND_0"
        after = self.wavefront.census()
        if stage == "generate":
            self.paths[batch, number] = after[alive]
            count = after[alive] - self._before.get(alive, 0)
        elif stage == "accumulate":
            count = sum(n for (b, _, s), n in self.items.items() if s == "generate" and b == batch)
        else:
            count = self._before.get(alive if stage == "extend" else self._queue(stage), 0)
        self.items[batch, number, stage] = count
        self._before = after

    def _queue(self, stage: str) -> str:
        """The queue that ``stage`` empties."""
        name, _, kind = stage.rstrip("]").partition("[")
        return f"SHADE_{list(self.wavefront.buffers.features.bsdfs).index(kind)}" if name == "shade" else name.upper()
