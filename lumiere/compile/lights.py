"""Lights → records, emitters, and the distribution from which one is chosen."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from lumiere.compile.geometry import Object, ShapeGroup
from lumiere.light import Light, luminance
from lumiere.light.distribution import integer_cdf
from lumiere.texture import Texture


@dataclass
class LightTable:
    """Lights in device order: the primitives that emit (``emitters``, ascending), then kind after kind."""

    emitters: np.ndarray
    kinds: dict[str, list[Light]] = field(default_factory=dict)
    cdf: np.ndarray | None = None

    @property
    def count(self) -> int:
        """All lights."""
        return len(self.emitters) + sum(len(members) for members in self.kinds.values())

    def first(self, kind: str) -> int:
        """Number of the first light of ``kind``."""
        before = list(self.kinds)[:list(self.kinds).index(kind)]
        return len(self.emitters) + sum(len(self.kinds[k]) for k in before)


def mean_emission(emission: tuple[float, float, float] | Texture | None) -> float:
    """Mean luminance of the radiance that a surface emits."""
    if emission is None:
        return 0.0
    return luminance(emission.average() if isinstance(emission, Texture) else emission)


def light_table(lights: list[Light], objects: list[Object], groups: list[ShapeGroup], scene_radius: float) -> LightTable:
    """Chooses by emitted power within a source (an object, or a light), and between sources half by power and half evenly:
    by power alone, a sky around a room would leave its lamp almost nothing.
    """
    emitters, sources, powers = [], [], []
    first = 0
    flux = np.array([np.pi * mean_emission(o.emission) * (2.0 if o.both_sides else 1.0) for o in objects])
    for group in groups:
        shining = np.flatnonzero((flux > 0.0)[group.objects])
        power = group.device_shape.areas(group.given[group.order[shining]]) * flux[group.objects[shining]]
        members = shining[power > 0.0]
        emitters.append(members + first)
        sources.append(group.objects[members].astype(np.int64))
        powers.append(power[power > 0.0])
        first += len(group.objects)
    table = LightTable(np.concatenate([*emitters, np.zeros(0, dtype=np.int64)]).astype(np.uint32))
    for light in lights:
        table.kinds.setdefault(light.device_kind, []).append(light)
    ordered = [light for members in table.kinds.values() for light in members]
    sources.append(np.arange(len(ordered)) + len(objects))
    powers.append(np.array([light.flux(scene_radius) for light in ordered], dtype=np.float64))
    source, power = np.concatenate(sources).astype(np.int64), np.concatenate(powers).astype(np.float64)
    if len(power) == 0:
        return table
    by_source = np.bincount(source, weights=power, minlength=len(objects) + len(ordered))
    shining = by_source > 0.0
    total = by_source.sum()
    if total > 0.0:
        share = np.where(shining, 0.5 * by_source / total + 0.5 / shining.sum(), 0.0)
        within = np.divide(power, by_source[source], out=np.zeros_like(power), where=shining[source])
        table.cdf = integer_cdf(share[source] * within)
    else:
        table.cdf = integer_cdf(power)
    return table
