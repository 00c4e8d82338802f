"""How far a render is."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """What the renderer tells after each batch: samples (over all pixels) done and wanted, and the seconds since the first."""

    samples_done: int
    samples_total: int
    seconds: float

    @property
    def fraction(self) -> float:
        """Part done, in [0, 1]."""
        return min(self.samples_done / self.samples_total, 1.0) if self.samples_total > 0 else 1.0

    @property
    def samples_per_second(self) -> float:
        """Mean rate so far; 0 before any time has passed."""
        return self.samples_done / self.seconds if self.seconds > 0.0 else 0.0

    @property
    def seconds_left(self) -> float | None:
        """Time to the end at that rate, or None where no sample is done."""
        rate = self.samples_per_second
        return max(self.samples_total - self.samples_done, 0) / rate if rate > 0.0 else None
