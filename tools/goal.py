"""Measures rendering to a goal: how often the true error is below the target, and adaptive against uniform sampling (docs/goal.md)."""

from __future__ import annotations

import argparse
import dataclasses
import sys
import time
from pathlib import Path

import numpy as np

import lumiere.doctor
from lumiere import api
from lumiere.goal.error import LUMINANCE, relative_error
from lumiere.rendering import Render
from lumiere.scene.model import Adaptive, Scene

SCENES = ("diffuse", "glass", "metal")

MOST_SPP = 1 << 16


def with_sampler(scene: Scene, **keys: object) -> Scene:
    """The scene with other values in its sampler."""
    return dataclasses.replace(scene, sampler=dataclasses.replace(scene.sampler, **keys))


def luminance(job: Render) -> np.ndarray:
    """(h, w) float64 of the picture."""
    return job.image({}).pixels.astype(np.float64) @ LUMINANCE


def truth(scene: Scene, spp: int, device: str | None) -> tuple[np.ndarray, float, float]:
    """A picture of many samples, its own relative error, and that of its mean."""
    job = Render(with_sampler(scene, spp=spp, seed=2**31), device)
    job.run()
    image = job.image({})
    known = image.pixels.astype(np.float64) @ LUMINANCE
    variance = (np.sqrt(image.variance) @ LUMINANCE) ** 2
    return known, float(np.mean(variance / (known**2 + 0.01 * known.mean() ** 2))) ** 0.5, float(variance.sum()) ** 0.5 / known.sum()


def coverage(job: Render, known: np.ndarray, of_mean: float, target: float, seeds: int) -> str:
    """In how many of the seeds the true error was at most the target, and what it cost; ``of_mean`` is the error of the mean of ``known``."""
    errors, stated, counts, biases = [], [], [], []
    for seed in range(seeds):
        job.restart(seed)
        job.run(target_error=target, spp_limit=MOST_SPP)
        picture = luminance(job)
        errors.append(relative_error(picture, known))
        stated.append(job.outcome.error.image)
        counts.append(job.counts.mean())
        biases.append(picture.mean() / known.mean() - 1.0)
    below = int(np.sum(np.array(errors) <= target))
    bias, deviation = np.mean(biases), (np.var(biases, ddof=1) / seeds + of_mean**2) ** 0.5
    return (f"{below} of {seeds} | {np.median(errors):.3f} | {max(errors):.3f} | {np.median(stated):.3f} | {np.median(counts):.0f} | "
            f"{100 * bias:+.3f} ± {196 * deviation:.3f} %")


def at_equal_time(scene: Scene, known: np.ndarray, own: float, seconds_each: float, seeds: int, device: str | None) -> str:
    """relMSE of adaptive sampling that is stopped after a time, and of uniform sampling in the time which that took; less that of the reference."""
    adaptive = Render(with_sampler(scene, adaptive=Adaptive(target_error=1e-6, max_spp=MOST_SPP)), device)
    uniform = Render(with_sampler(scene, spp=MOST_SPP), device)
    uniform.run(time_limit=0.5)
    errors = {"adaptive": [], "uniform": []}
    seconds = []
    for seed in range(seeds + 1):
        adaptive.restart(seed)
        begin = time.perf_counter()
        adaptive.run(time_limit=seconds_each)
        taken = time.perf_counter() - begin
        uniform.restart(seed + 10000)
        uniform.run(time_limit=taken)
        if seed == 0:  # the first launches build
            continue
        seconds.append(taken)
        errors["adaptive"].append(relative_error(luminance(adaptive), known) ** 2 - own**2)
        errors["uniform"].append(relative_error(luminance(uniform), known) ** 2 - own**2)
    ratio = np.log(np.array(errors["uniform"]) / np.array(errors["adaptive"]))
    half = 1.96 * ratio.std(ddof=1) / seeds**0.5
    return (f"{np.median(seconds):.2f} | {np.mean(errors['adaptive']):.2e} | {np.mean(errors['uniform']):.2e} | "
            f"{np.exp(ratio.mean()):.2f} ({np.exp(ratio.mean() - half):.2f} to {np.exp(ratio.mean() + half):.2f})")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", type=Path, help="scene files (default: the doctor's)")
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--target", type=float, default=0.1)
    parser.add_argument("--spp", type=int, default=1 << 15, help="of the reference")
    parser.add_argument("--size", type=int, default=32, help="pixels each way")
    parser.add_argument("--device")
    parser.add_argument("--pairs", type=int, default=12, help="of renders at equal time; 0: none")
    parser.add_argument("--seconds", type=float, default=2.0, help="of each of those")
    parser.add_argument("--samplings", default="uniform,adaptive", help="whose coverage is measured")
    options = parser.parse_args()
    folder = Path(lumiere.doctor.__file__).parent / "data"
    rows = []
    print("| scene | sampling | true error ≤ target | median error | largest | median stated | median spp | bias of the mean |")
    print("|---|---|---|---|---|---|---|---|")
    for path in options.scenes or [folder / f"{name}.json" for name in SCENES]:
        name = path.stem
        scene = api.with_options(api.load(path), {"width": options.size, "height": options.size})
        known, own, of_mean = truth(scene, options.spp, options.device)
        for sampling, adaptive in (("uniform", None), ("adaptive", Adaptive(target_error=options.target, max_spp=MOST_SPP))):
            if sampling in options.samplings.split(","):
                job = Render(with_sampler(scene, adaptive=adaptive), options.device)
                print(f"| {name} | {sampling} | {coverage(job, known, of_mean, options.target, options.seeds)} |", flush=True)
        if not options.pairs:
            continue
        result = at_equal_time(scene, known, own, options.seconds, options.pairs, options.device)
        rows.append(f"| {name} | {own:.4f} | {result} |")
        print(rows[-1], file=sys.stderr, flush=True)
    print("\n| scene | reference's own error | seconds | relMSE adaptive | relMSE uniform | uniform / adaptive (95 %) |\n|---|---|---|---|---|---|")
    print("\n".join(rows))


if __name__ == "__main__":
    main()
