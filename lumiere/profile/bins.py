"""Rounds taken together, so that many of them still fit on a page."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class RoundBin:
    """Consecutive rounds, numbered through all batches: means of their counts, and sums of their seconds."""

    first: int
    last: int
    batch: int
    paths: float
    items: dict[str, float]
    seconds: dict[str, float]

    @property
    def label(self) -> str:
        """``7`` or ``7–9``."""
        return str(self.first) if self.first == self.last else f"{self.first}–{self.last}"


def bins(rounds: list[dict[str, Any]], stages: list[str], at_most: int) -> list[RoundBin]:
    """At most ``at_most`` bins of the summary's ``rounds``; those that only accumulate a batch are no rounds."""
    real = [r for r in rounds if "generate" in r["seconds"]]
    size = max(1, -(-len(real) // at_most))
    found = []
    for first in range(0, len(real), size):
        part = real[first:first + size]
        found.append(RoundBin(first, first + len(part) - 1, part[0]["batch"], sum(r["paths"] for r in part) / len(part),
                              {s: sum(r["items"].get(s, 0) for r in part) / len(part) for s in stages},
                              {s: sum(r["seconds"].get(s, 0.0) for r in part) for s in stages}))
    return found
