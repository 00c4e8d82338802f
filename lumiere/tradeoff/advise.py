"""Which setting to choose, and why."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from lumiere.tradeoff.measure import Measurement, Study

OF_MANY = 1.6
"""The best of some twenty settings is the luckiest of them: their intervals, of 95 % each, are widened to 99.8 %."""


@dataclass(frozen=True)
class Choice:
    """``goal`` is what was asked; ``spp`` and ``seconds`` what the chosen setting takes; ``error`` the relMSE that it should then have."""

    goal: str
    measurement: Measurement | None
    spp: int
    seconds: float
    error: float
    why: str


def _best_known(study: Study) -> list[Measurement]:
    """Each setting at its largest spp."""
    best: dict[str, Measurement] = {}
    for m in study.measurements:
        if m.setting.name not in best or m.spp > best[m.setting.name].spp:
            best[m.setting.name] = m
    return list(best.values())


def _bias2(m: Measurement) -> float:
    """Bias² to reckon with: where the interval holds 0, none of a setting from which none is expected, and else its upper end."""
    if m.bias2.differs_from_zero:
        return max(m.bias2.value, 0.0)
    return 0.0 if m.setting.unbiased else max(m.bias2.interval[1], 0.0)


class _Rates:
    """Variance × seconds of each setting: what a render's variance is over its time.

    Both fall a little more than in proportion to spp, so a setting measured at few spp is compared with the scene's own at as many.
    """

    def __init__(self, study: Study) -> None:
        self.ladder = {m.spp: m for m in study.ladder}
        self.own = study.ladder[-1]

    def __call__(self, m: Measurement) -> float:
        beside = self.ladder.get(m.spp, self.own)
        return m.variance.value * m.seconds * (self.own.variance.value * self.own.seconds) / (beside.variance.value * beside.seconds)


def _relative_uncertainty(m: Measurement) -> float:
    of_variance = m.variance.half_width / m.variance.value if m.variance.value > 0.0 else 0.0
    return math.hypot(of_variance, m.seconds_half_width / m.seconds)


def choices(study: Study) -> list[Choice]:
    """For a render of 10 s, and for a relMSE of 10⁻³."""
    known, rate = _best_known(study), _Rates(study)
    return [_for_time(known, rate, 10.0), _for_error(known, rate, 1e-3)]


def _for_time(known: list[Measurement], rate: _Rates, seconds: float) -> Choice:
    own = rate.own

    def predicted(m: Measurement) -> float:
        left = seconds - m.accelerator_seconds
        return _bias2(m) + rate(m) / left if left > 0.0 else math.inf

    best = _unless_only_luck(min(known, key=predicted), own, predicted)
    spp = max(1, round((seconds - best.accelerator_seconds) * best.spp / best.seconds))
    return Choice(f"{seconds:g} s", best, spp, seconds, predicted(best), _reasons(best, rate, predicted(best), predicted(own), "relMSE"))


def _for_error(known: list[Measurement], rate: _Rates, error: float) -> Choice:
    own = rate.own

    def needed(m: Measurement) -> float:
        room = error - _bias2(m)
        return rate(m) / room + m.accelerator_seconds if room > 0.0 else math.inf

    goal = f"relMSE {error:.0e}"
    best = _unless_only_luck(min(known, key=needed), own, needed)
    if not math.isfinite(needed(best)):
        return Choice(goal, None, 0, math.inf, error, "every setting measured has a bias² above that against the reference; the smallest is "
                      f"{min(_bias2(m) for m in known):.2g}")
    spp = max(1, math.ceil((needed(best) - best.accelerator_seconds) * best.spp / best.seconds))
    return Choice(goal, best, spp, needed(best), error, _reasons(best, rate, needed(best), needed(own), "seconds"))


def _unless_only_luck(best: Measurement, own: Measurement, cost: Callable[[Measurement], float]) -> Measurement:
    """The scene's own settings, where the better ones are better by less than variances and times are uncertain."""
    if best is own:
        return own
    gain = cost(own) / cost(best) - 1.0 if cost(best) > 0.0 else math.inf
    return best if gain > OF_MANY * math.hypot(_relative_uncertainty(best), _relative_uncertainty(own)) else own


def _reasons(best: Measurement, rate: _Rates, cost: float, own_cost: float, unit: str) -> str:
    bias = f"its bias² of {best.bias2.value:.1e} ± {best.bias2.half_width:.1e} " + (
        "is counted in" if _bias2(best) > 0.0 else "is not told from 0")
    if best is rate.own:
        return f"no change is better by more than variances and times are uncertain; {bias}"
    share = f"{own_cost / cost:.2f} times less {unit} than with the scene's own settings ({cost:.2g} against {own_cost:.2g})"
    return f"{share}; variance × time is {rate(best):.2g} against {rate(rate.own):.2g}, and {bias}"
