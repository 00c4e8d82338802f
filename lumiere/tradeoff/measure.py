"""Renders the settings within a budget of time."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from lumiere.errors import LumiereError, UsageError
from lumiere.rendering import Render
from lumiere.scene.model import Scene
from lumiere.tradeoff import metrics
from lumiere.tradeoff.settings import OWN, Setting, own, settings, strictest, with_spp
from lumiere.tradeoff.statistics import Estimate, Reference, bias_and_variance, slope
from lumiere.wavefront.batch import Batch

SEEDS = 16
"""Independent pictures a setting."""

BESIDE = 2
"""After so many pictures of a change comes one of the scene's own settings, to time the change against."""

OVERHEAD = 1.1 * (1.0 + 1.0 / BESIDE)
"""Of measuring a setting, over rendering its pictures."""

REFERENCE_SHARE, LADDER_SHARE, CHANGES_SHARE = 0.25, 0.15, 0.8
"""Parts of the budget for the reference and for the scene's own settings at several spp; and the part of what builds leave for one change at a time."""

LARGEST_SPP = 1024

FIRST_SEED = 1000
"""Seeds of the pictures; the reference's begin behind them."""


@dataclass
class Measurement:
    """What came of a setting at one spp. ``seconds``: median of the render phase, with half of its 95 % interval;
    ``mean`` and ``example`` are (h, w, 3)."""

    setting: Setting
    spp: int
    seconds: float
    seconds_half_width: float
    rel_mse: float
    rel_mse_trimmed: float
    flip: float | None
    bias2: Estimate
    variance: Estimate
    example: np.ndarray
    mean: np.ndarray
    slope: float | None = None
    """Of log relative error (the root of bias² + variance) against log seconds, over the setting's spp."""
    accelerator_seconds: float = 0.0
    """Building the accelerators, once a scene."""

    @property
    def efficiency(self) -> float:
        """1 / (variance × seconds)."""
        product = self.variance.value * self.seconds
        return 1.0 / product if product > 0.0 else float("inf")

    @property
    def error(self) -> float:
        """bias² + variance, the relMSE against the truth as far as the reference knows it."""
        return max(self.bias2.value, 0.0) + self.variance.value


@dataclass
class Study:
    """All measurements, the reference, and what was left out and why."""

    scene: Scene
    device: str
    reference: Reference
    reference_text: str
    weight: np.ndarray
    measurements: list[Measurement] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def reference_error(self) -> float:
        """relMSE of the reference itself, from its variance."""
        return float((self.weight * self.reference.variance).mean())

    @property
    def ladder(self) -> list[Measurement]:
        """The scene's own settings, by spp."""
        return sorted((m for m in self.measurements if m.setting.factor == OWN), key=lambda m: m.spp)


class Runner:
    """Renders settings, and knows what the next one will cost."""

    def __init__(self, device: str | int | None, budget: float, tell: Callable[[str], None]) -> None:
        self.device, self.tell = device, tell
        self.begin = time.perf_counter()
        self.budget = budget
        self.build_seconds = 0.0
        self.sample_seconds = 0.0
        """Of one sample of every pixel."""

    @property
    def elapsed(self) -> float:
        """Seconds since the start."""
        return time.perf_counter() - self.begin

    def pictures(self, scene: Scene, setting: Setting, spp: int, first_seed: int, count: int) -> tuple[np.ndarray, list[float], Render]:
        """(count, h, w, 3) of independent seeds, the seconds of each, and the render."""
        job = self.job(scene, setting, spp)
        return (*repeat(job, first_seed, count), job)

    def job(self, scene: Scene, setting: Setting, spp: int) -> Render:
        """A render that has launched each kernel once: what a first launch costs is no part of a measurement."""
        begin = time.perf_counter()
        # Built for many samples, so that batches are as large at every spp; but strata are laid out for the samples that there are.
        changed = setting.change(scene)
        built_for = spp if changed.sampler.type == "stratified" else max(spp, LARGEST_SPP)
        job = Render(with_spp(changed, built_for), self.device, overrides=setting.overrides)
        job.wavefront.render(Batch(0, 1, 1, 0))
        job.wavefront.finish()
        job.scene = with_spp(job.scene, spp)
        if setting.builds:
            self.build_seconds = 0.5 * (self.build_seconds + time.perf_counter() - begin)
        return job


def repeat(job: Render, first_seed: int, count: int) -> tuple[np.ndarray, list[float]]:
    """Pictures (count, h, w, 3) of the seeds from ``first_seed`` on, and their render seconds."""
    pictures, seconds = [], []
    for seed in range(first_seed, first_seed + count):
        job.restart(seed)
        job.run()
        pictures.append(job.image({}).pixels)
        seconds.append(job.seconds["render"])
    return np.stack(pictures), seconds


def study(scene: Scene, *, reference: Path | None, budget: float, device: str | int | None, tell: Callable[[str], None]) -> Study:
    """Measures what fits in ``budget`` seconds. ``tell`` gets a line a step."""
    runner = Runner(device, budget, tell)
    scene = replace(scene, film=replace(scene.film, aovs=()))
    tell("the scene's own settings")
    first, seconds, job = runner.pictures(scene, own(), 1, FIRST_SEED, SEEDS)
    runner.build_seconds = runner.build_seconds or runner.elapsed - sum(seconds)
    runner.sample_seconds = max(float(np.median(seconds)), 1e-4)
    if reference is not None:
        known, text = read_reference(reference, first.shape[1:])
    else:
        known, text = _render_reference(scene, runner)
    result = Study(scene, job.device.name.strip(), known, text, metrics.weights(known.mean))
    result.measurements.append(_measured(own(), 1, first, seconds, result, job))
    per_picture = runner.sample_seconds * SEEDS
    _ladder(result, runner, job, per_picture)
    wanted = list(settings(scene, float(known.mean.mean())))
    left = runner.budget - runner.elapsed
    room = left - sum(runner.build_seconds for s in wanted if s.builds)
    most = _power_of_two_below(CHANGES_SHARE * max(room, 0.3 * left) / (1.25 * OVERHEAD * per_picture * max(1, len(wanted))))
    for levels in ((max(1, most // 4), most), (4 * most,)):
        for setting in wanted:
            levels = sorted(set(levels))
            cost = (runner.build_seconds if setting.builds and most in levels else 1.5) + OVERHEAD * per_picture * sum(levels)
            if runner.elapsed + cost > runner.budget:
                if most in levels:
                    result.left_out.append(f"{setting.name}: {cost:.0f} s more would not have fitted in the budget")
                continue
            tell(f"{setting.name}, {' and '.join(map(str, levels))} spp")
            try:
                _one(result, runner, job, setting, levels)
            except LumiereError as error:
                result.left_out.append(f"{setting.name}: {error}")
    _slopes(result)
    names = list(dict.fromkeys(m.setting.name for m in result.measurements))
    result.measurements.sort(key=lambda m: (names.index(m.setting.name), m.spp))
    result.seconds = runner.elapsed
    return result


def _one(result: Study, runner: Runner, own_job: Render, setting: Setting, levels: list[int]) -> None:
    """Measures a setting at each spp of ``levels``, beside the scene's own: a machine's speed drifts, and what was timed side by side is compared."""
    job = None
    for spp in levels:
        beside = next((m for m in result.ladder if m.spp == spp), None)
        if beside is None:
            beside = _measured(own(), spp, *_again(own_job, spp), result, own_job)
            result.measurements.append(beside)
        if job is None or job.scene.sampler.type == "stratified":
            job = runner.job(result.scene, setting, spp)
        job.scene, own_job.scene = with_spp(job.scene, spp), with_spp(own_job.scene, spp)
        pictures, seconds = [], []
        for seed in range(FIRST_SEED, FIRST_SEED + SEEDS, BESIDE):
            some, theirs = repeat(job, seed, BESIDE)
            pictures.append(some)
            speed = repeat(own_job, seed, 1)[1][0]
            seconds += [beside.seconds * value / speed for value in theirs]
        result.measurements.append(_measured(setting, spp, np.concatenate(pictures), seconds, result, job))


def _again(job: Render, spp: int) -> tuple[np.ndarray, list[float]]:
    """As ``repeat``, at another spp."""
    job.scene = with_spp(job.scene, spp)
    return repeat(job, FIRST_SEED, SEEDS)


def _power_of_two_below(value: float) -> int:
    return 2 ** min(int(np.log2(max(value, 1.0))), int(np.log2(LARGEST_SPP)))


def _ladder(result: Study, runner: Runner, job: Render, per_picture: float) -> None:
    """The scene's own settings at 4, 16, … spp, as far as their share goes."""
    spent, spp = 0.0, 4
    while spent + per_picture * spp <= LADDER_SHARE * runner.budget:
        result.measurements.append(_measured(own(), spp, *_again(job, spp), result, job))
        spent += per_picture * spp
        spp *= 4


def _render_reference(scene: Scene, runner: Runner) -> tuple[Reference, str]:
    """By the strictest settings, as many samples as its share of the budget allows."""
    strict = strictest(scene)
    spp = _power_of_two_below(REFERENCE_SHARE * runner.budget / (1.3 * SEEDS * runner.sample_seconds))
    runner.tell(f"the reference: {SEEDS} seeds of {spp} spp")
    replicates, seconds, _ = runner.pictures(strict, own(), spp, FIRST_SEED + SEEDS, SEEDS)
    integrator = strict.integrator
    text = (f"rendered: {SEEDS} seeds of {spp} spp, max_depth {integrator.max_depth}, light_sampling {integrator.light_sampling}, "
            f"no clamping, strict maths, {sum(seconds):.1f} s")
    variance = replicates.var(axis=0, ddof=1, dtype=np.float64) / SEEDS
    return Reference(replicates.mean(axis=0, dtype=np.float64), variance, replicates), text


def read_reference(path: Path, shape: tuple[int, ...]) -> tuple[Reference, str]:
    """A reference from an EXR, with its error where it has a layer ``variance``. Raises UsageError where its size is another."""
    import OpenImageIO

    from lumiere.imagefile import read_image

    pixels = read_image(path)[..., :3].astype(np.float64)
    if pixels.shape != shape:
        raise UsageError(f"{path}: found a reference of {pixels.shape[1]} × {pixels.shape[0]} with {pixels.shape[2]} channels, expected "
                         f"{shape[1]} × {shape[0]} with 3; give --width and --height, or another reference")
    file = OpenImageIO.ImageInput.open(str(path))
    names = list(file.spec().channelnames) if file is not None else []
    layer = [f"variance.{channel}" for channel in "RGB"]
    if file is not None and all(name in names for name in layer):
        values = file.read_image("float")
        variance = np.stack([values[..., names.index(name)] for name in layer], axis=-1).astype(np.float64)
        return Reference(pixels, np.nan_to_num(variance, posinf=0.0)), f"{path}, its error by its layer `variance`"
    return Reference(pixels, np.zeros_like(pixels)), f"{path}, taken as exact since it has no layer `variance`"


def _measured(setting: Setting, spp: int, pictures: np.ndarray, seconds: list[float], result: Study, job: Render) -> Measurement:
    reference = result.reference.mean
    bias2, variance = bias_and_variance(pictures, result.reference, result.weight)
    return Measurement(
        setting, spp, float(np.median(seconds)), _median_half_width(seconds), float(np.mean([metrics.rel_mse(p, reference) for p in pictures])),
        float(np.mean([metrics.rel_mse(p, reference, metrics.TRIMMED) for p in pictures])), metrics.flip(pictures[0], reference),
        bias2, variance, pictures[0], pictures.mean(axis=0, dtype=np.float64), accelerator_seconds=job.seconds["accelerator"])


def _median_half_width(seconds: list[float]) -> float:
    """Half of the 95 % interval of the median: from order statistics (David & Nagaraja 2003, §7.1)."""
    ordered, reach = np.sort(seconds), 0.98 * len(seconds) ** 0.5
    low, high = int(max(0.0, np.floor(0.5 * len(ordered) - reach))), int(min(len(ordered) - 1.0, np.ceil(0.5 * len(ordered) + reach - 1.0)))
    return float(ordered[high] - ordered[low]) / 2.0


def _slopes(result: Study) -> None:
    groups: dict[str, list[Any]] = {}
    for m in result.measurements:
        groups.setdefault(m.setting.name, []).append(m)
    for members in groups.values():
        value = slope([m.seconds for m in members], [m.error**0.5 for m in members])
        for m in members:
            m.slope = value
