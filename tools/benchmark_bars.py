"""What Lumière sets itself to reach, beside what was measured, for tools/benchmark.py.

GPU bars are for one H100. The PoCL of PyPI is version 3.0, which is given a quarter less in whole renders, and a twentieth in rays.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Bar:
    """``of`` takes the record's value, or raises KeyError where it was not measured; ``cpu``, ``old_pocl`` and ``gpu``: at least, or with ``most`` at
    most; None for no such bar on that kind of device. ``summit``, where there is one, lies beyond the bar."""

    what: str
    unit: str
    of: Callable[[dict[str, Any]], float]
    cpu: float | None = None
    old_pocl: float | None = None
    gpu: float | None = None
    most: bool = False
    summit: str = ""

    def shown(self, kind: str) -> bool:
        """Whether it is for devices of ``kind``; one that is a summit alone is for all."""
        return self.limit(kind) is not None or self.cpu is self.old_pocl is self.gpu is None

    def limit(self, kind: str) -> float | None:
        """The bar on a device of ``kind``: cpu, old_pocl or gpu."""
        return {"cpu": self.cpu, "old_pocl": self.old_pocl, "gpu": self.gpu}[kind]


def device_kind(gpu: bool, driver: str) -> str:
    """cpu, old_pocl or gpu."""
    if gpu:
        return "gpu"
    return "old_pocl" if re.match(r"Portable Computing Language [0-2]\.|Portable Computing Language 3\.0", driver) else "cpu"


def _by_embree(scene: str, kind: str) -> Callable[[dict[str, Any]], float]:
    def of(told: dict[str, Any]) -> float:
        part = told["rays"][scene]
        return part["kinds"][kind]["by Embree"][part["own"]]

    return of


def _rays(scene: str, kind: str) -> Callable[[dict[str, Any]], float]:
    def of(told: dict[str, Any]) -> float:
        part = told["rays"][scene]
        return part["kinds"][kind]["rays a second"][part["own"]]["median"] * 1e-9

    return of


def _by_peer(scene: str, peer: str) -> Callable[[dict[str, Any]], float]:
    def of(told: dict[str, Any]) -> float:
        peers = told["speed"][scene]["peers"]
        found = [row["ours by it"] for name, row in peers.items() if name.startswith(peer)]
        if not found:
            raise KeyError(peer)
        return found[0]

    return of


def _samples(scene: str) -> Callable[[dict[str, Any]], float]:
    return lambda told: told["speed"][scene]["samples a second"]["median"] * 1e-6


def _seconds(name: str) -> Callable[[dict[str, Any]], float]:
    return lambda told: told["start"][name]["median"]


def _build(told: dict[str, Any]) -> float:
    if told["preparation"]["triangles"] < 1e6:
        raise KeyError("million")
    return told["preparation"]["accelerator"]["median"]


def _bars() -> Iterator[Bar]:
    yield Bar("import", "s", _seconds("import"), 0.3, 0.3, 0.3, most=True)
    yield Bar("cold first pixel, Cornell box", "s", _seconds("cold start"), 4.0, 4.0, 2.0, most=True)
    yield Bar("warm first pixel, Cornell box", "s", _seconds("warm start"), 0.8, 0.8, 0.8, most=True)
    yield Bar("million: build and encode", "s", _build, 0.4, 0.4, 0.03, most=True)
    yield Bar("million: node fill", "", lambda told: next(iter(told["rays"]["million"]["node fill"].values())), 0.65, 0.65)
    for kind in ("primary", "bounce", "any-hit"):
        yield Bar(f"million: {kind} rays by Embree's", "×", _by_embree("million", kind), 1.0, 0.95)
    for kind in ("primary", "bounce", "any-hit"):
        yield Bar(f"20k: {kind} rays by Embree's", "×", _by_embree("20k", kind), 1.2, 1.2)
    yield Bar("million: primary rays", "Grays/s", _rays("million", "primary"), gpu=6.0)
    yield Bar("million: bounce rays", "Grays/s", _rays("million", "bounce"), gpu=2.2)
    yield Bar("Cornell box by Mitsuba", "×", _by_peer("cornell", "Mitsuba"), 1.5, 1.125)
    yield Bar("million by Mitsuba", "×", _by_peer("million", "Mitsuba"), 0.75, 0.5625, summit="1")
    yield Bar("20 million by Mitsuba", "×", _by_peer("20million", "Mitsuba"), summit="1")
    for scene, name in (("cornell", "Cornell box"), ("million", "million"), ("20million", "20 million")):
        for peer in ("Cycles", "LuxCore"):
            yield Bar(f"{name} by {peer}", "×", _by_peer(scene, peer), 2.0, 1.5)
    yield Bar("million", "Msamples/s", _samples("million"), gpu=450.0)
    yield Bar("Cornell box", "Msamples/s", _samples("cornell"), gpu=700.0, summit="1000")
    yield Bar("320 triangles", "Msamples/s", _samples("320"), gpu=2200.0)
    for scene, name in (("cornell", "Cornell box"), ("million", "million")):
        for spp in ("16", "64"):
            yield Bar(f"{name}: relative variance at {spp} spp by Mitsuba's multijitter", "×",
                      lambda told, scene=scene, spp=spp: told["error"][scene][spp]["ours by it"], 1.0, 1.0, most=True)


BARS = tuple(_bars())


def table(told: dict[str, Any]) -> str:
    """Every bar whose figure was measured, as a Markdown table."""
    kind = told["device kind"]
    lines = ["| what | bar | figure | figure / bar | met |", "|---|---|---|---|---|"]
    for bar in BARS:
        try:
            value = bar.of(told)
        except (KeyError, StopIteration):
            continue
        limit = bar.limit(kind)
        if not bar.shown(kind):
            continue
        beyond = f" (summit {bar.summit})" if bar.summit else ""
        text = "" if limit is None else f"{'≤' if bar.most else '≥'} {limit:g}"
        met = "" if limit is None else "yes" if (value <= limit if bar.most else value >= limit) else "no"
        lines.append(f"| {bar.what} | {text}{beyond} {bar.unit} | {value:.3g} | {'' if limit is None else f'{value / limit:.2f}'} | {met} |")
    return "\n".join(lines)
