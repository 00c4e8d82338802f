"""Figures of tools/benchmark.py and its parts, and a word to whoever waits for them."""

from __future__ import annotations

import sys
import time
from statistics import median
from typing import Any


def figure(values: list[float], unit: str) -> dict[str, Any]:
    """Median, least and most of ``values``."""
    return {"median": median(values), "min": min(values), "max": max(values), "values": values, "unit": unit}


def let_rest() -> None:
    """Waits until the threads of whoever had the last turn sleep: those of Intel's runtime go on looking for work and slow the next in turn."""
    time.sleep(0.1)


def tell(step: str) -> None:
    """A line for whoever waits."""
    print(step, file=sys.stderr, flush=True)
