"""Observers of the wavefront's launches: one keeps their times, one counts what each finds to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lumiere.wavefront.loop import Wavefront
from lumiere.wavefront.source import TRACING


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


@dataclass(frozen=True)
class Count:
    """What one launch of a stage found and left: ``items`` that waited for it, ``slots`` that it looked at, ``out`` what it gave to other stages, and
    where it traces ``visits``, (VISIT_BOUNCES, 3) uint64: rays, nodes and primitives by bounce."""

    items: int
    slots: int
    out: dict[str, int]
    visits: np.ndarray | None = None


@dataclass
class Census:
    """An observer that counts each launch. It waits for every one, so it is for a run that nobody times; the wavefront must count visits.

    ``counts[batch, round, stage]``; ``paths[batch, round]`` counts the paths that are alive when the round's new ones have started.
    """

    wavefront: Wavefront
    batch: int = -1
    counts: dict[tuple[int, int, str], Count] = field(default_factory=dict)
    paths: dict[tuple[int, int], int] = field(default_factory=dict)
    _before: dict[str, int] = field(default_factory=dict)
    _visited: dict[str, np.ndarray] = field(default_factory=dict)

    def __call__(self, stage: str, number: int, event: Any) -> None:
        batch = _next_batch(self.batch, stage, number)
        if batch != self.batch:
            self.batch, self._before = batch, {}
        alive = f"EXTEND_{number % 2}" if self.wavefront.policy.compacted else "EXTEND_0"
        after = self.wavefront.census()
        if stage == "generate":
            self.paths[batch, number] = after[alive]
            items = after[alive] - self._before.get(alive, 0)
        elif stage == "accumulate":
            items = sum(count.items for (b, _, s), count in self.counts.items() if s == "generate" and b == batch)
        else:
            items = self._before.get(alive if stage == "extend" else self._queue(stage), 0)
        self.counts[batch, number, stage] = Count(items, self.wavefront.slots, self._given(after, stage), self._newly_visited(stage))
        self._before = after

    def _queue(self, stage: str) -> str:
        """The queue that ``stage`` empties."""
        name, _, kind = stage.rstrip("]").partition("[")
        return f"SHADE_{list(self.wavefront.buffers.features.bsdfs).index(kind)}" if name == "shade" else name.upper()

    def _stage(self, queue: str) -> str:
        """The stage that empties ``queue``."""
        name, _, number = queue.partition("_")
        return f"shade[{list(self.wavefront.buffers.features.bsdfs)[int(number)]}]" if name == "SHADE" else name.lower()

    def _given(self, after: dict[str, int], stage: str) -> dict[str, int]:
        """By how much the queues of other stages have grown."""
        given: dict[str, int] = {}
        for queue in self.wavefront.queues if stage != "accumulate" else ():
            grown = after[queue] - self._before.get(queue, 0)
            if grown > 0 and not queue.startswith("IDLE"):
                given[self._stage(queue)] = given.get(self._stage(queue), 0) + grown
        return given

    def _newly_visited(self, stage: str) -> np.ndarray | None:
        if stage not in TRACING:
            return None
        total = self.wavefront.visits(stage)
        new = total - self._visited.get(stage, 0)
        self._visited[stage] = total
        return new
