"""Renders the pictures that `lumiere doctor` compares with, lumiere/doctor/data/*.npz: 16 seeds, their mean and its variance."""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path

import numpy as np

import lumiere.doctor
from lumiere.doctor.checks import SCENES, scene_of
from lumiere.rendering import Render

SEEDS = 16


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--spp", type=int, default=2048, help="of each seed")
    parser.add_argument("--device")
    options = parser.parse_args()
    for name in SCENES:
        scene = scene_of(name)
        job = Render(dataclasses.replace(scene, sampler=dataclasses.replace(scene.sampler, spp=options.spp)), options.device)
        seeds = []
        for seed in range(SEEDS):
            job.restart(100 + seed)
            job.run()
            seeds.append(job.image({}).pixels.astype(np.float64))
        path = Path(lumiere.doctor.__file__).parent / "data" / f"{name}.npz"
        np.savez_compressed(path, mean=np.mean(seeds, axis=0).astype(np.float32), variance=(np.var(seeds, axis=0, ddof=1) / SEEDS).astype(np.float32))
        print(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
