"""Types of arguments, and how numbers are shown."""

from __future__ import annotations

import argparse
from collections.abc import Callable


def whole(low: int, high: int | None = None) -> Callable[[str], int]:
    """A type for argparse: a whole number from ``low`` to ``high``."""
    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = low - 1
        if value < low or (high is not None and value > high):
            bounds = f"from {low}" if high is None else f"from {low} to {high}"
            raise argparse.ArgumentTypeError(f"found '{text}', expected a whole number {bounds}")
        return value

    return parse


def seconds(text: str) -> float:
    """A type for argparse: a finite time above 0."""
    return _positive(text, "seconds")


def above_zero(text: str) -> float:
    """A type for argparse: a finite number above 0."""
    return _positive(text, "a number")


def _positive(text: str, what: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"found '{text}', expected {what} above 0")
    return value


def with_prefix(value: float, unit: str) -> str:
    """``value`` with three digits and a metric prefix: ``12.3 Msamples/s``."""
    for prefix in ("", "k", "M", "G"):
        if value < 999.5 or prefix == "G":
            return f"{value:.3g} {prefix}{unit}" if value < 100 else f"{value:.0f} {prefix}{unit}"
        value /= 1000.0
    raise AssertionError("the last prefix returns")


def clock(seconds: float) -> str:
    """``m:ss``, or ``h:mm:ss`` from an hour on."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
