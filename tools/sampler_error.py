"""Noise at equal samples, ours by sampler and Mitsuba's: python tools/sampler_error.py SCENE [--spp 16 64] [--peer-python P].

The relative variance of a pixel, from 16 seeds: the mean over values of s² / (M² + 0.01 m²), s² the variance between seeds, M their mean, m the picture's. It
needs no reference. The scene has to be one that tools/benchmark_peer.py can export.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from benchmark_peer import RENDERERS, RendererPeer, export

from lumiere.rendering import Render
from lumiere.scene.load import load

SEEDS = 16


def relative_variance(pictures: Iterable[np.ndarray]) -> tuple[float, float]:
    """The measure above, and the mean of all pixels."""
    values = np.stack([np.asarray(picture, np.float64) for picture in pictures])
    mean = values.mean(axis=0)
    return float(np.mean(values.var(axis=0, ddof=1) / (mean**2 + 0.01 * mean.mean() ** 2))), float(mean.mean())


def ours(scene: Any, device: str | None = None) -> Iterator[np.ndarray]:
    """Pictures of ``scene`` from the seeds."""
    render = Render(scene, device)
    for seed in range(SEEDS):
        render.restart(seed)
        render.run()
        yield render.image({}).pixels


def theirs(scene: Any, python: str, sampler: str) -> Iterator[np.ndarray]:
    """The same by Mitsuba's ``sampler``."""
    with tempfile.TemporaryDirectory() as folder:
        export(scene, Path(folder), variant="llvm_ad_rgb", sampler=sampler)
        peer = RendererPeer(RENDERERS[0], python, Path(folder))
        for seed in range(SEEDS):
            peer.render(seed, scene.sampler.spp)
            yield peer.picture()
        peer.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("--spp", type=int, nargs="+", default=[16, 64], help="squares, for samplers in strata")
    parser.add_argument("--size", type=int, default=64, help="pixels of width and height")
    parser.add_argument("--peer-python", help="interpreter that has Mitsuba (default: without Mitsuba)")
    options = parser.parse_args()
    scene = load(options.scene)
    scene = replace(scene, film=replace(scene.film, width=options.size, height=options.size),
                    integrator=replace(scene.integrator, max_depth=7, russian_roulette_depth=None))
    print("| spp | sampler | relative variance | mean |\n|---|---|---|---|")
    for spp in options.spp:
        rows = [(kind, ours(replace(scene, sampler=replace(scene.sampler, type=kind, spp=spp)))) for kind in ("sobol", "stratified", "independent")]
        if options.peer_python:
            taken = replace(scene, sampler=replace(scene.sampler, spp=spp))
            rows += [(f"Mitsuba {kind}", theirs(taken, options.peer_python, kind)) for kind in ("multijitter", "independent")]
        for name, pictures in rows:
            variance, mean = relative_variance(pictures)
            print(f"| {spp} | {name} | {variance:.4g} | {mean:.5g} |", flush=True)


if __name__ == "__main__":
    main()
