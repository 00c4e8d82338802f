"""What energy compensation gives and costs: white spheres under a white sky, with it and without.

    python tools/compensation.py [--device D] [--spp 64]

A sphere that loses nothing cannot be seen: `lost` is how much darker than the sky its disk is. Renders take turns; `time` is the median of seven with
compensation over that without.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from lumiere.rendering import Render
from lumiere.scene.load import load

KINDS = {"conductor": {"type": "conductor"}, "dielectric": {"type": "dielectric"}, "plastic": {"type": "plastic", "albedo": 1.0}}
ROUGHNESSES = (0.3, 0.6, 1.0)
RUNS = 7
SIZE = 192


def job(material: dict[str, Any], compensation: bool, spp: int, device: str | None) -> Render:
    """A sphere that fills most of the picture."""
    return Render(load({"scene": {
        "camera": {"type": "orthographic", "position": [0, 0, 9], "look_at": [0, 0, 0], "height": 2}, "film": {"width": SIZE, "height": SIZE},
        "integrator": {"max_depth": 64, "russian_roulette_depth": None, "energy_compensation": compensation}, "sampler": {"spp": spp},
        "geometry": [{"type": "sphere", "radius": 1, "material": material}], "lights": [{"type": "environment", "radiance": 1}]}}), device)


def measure(material: dict[str, Any], spp: int, device: str | None) -> tuple[dict[bool, float], float]:
    """What is lost, without compensation (False) and with it, and the ratio of the times."""
    jobs = {compensation: job(material, compensation, spp, device) for compensation in (False, True)}
    seconds: dict[bool, list[float]] = {False: [], True: []}
    for turn in range(RUNS + 1):
        for compensation, of in jobs.items():
            of.restart(turn)
            begin = time.perf_counter()
            of.run()
            if turn:
                seconds[compensation].append(time.perf_counter() - begin)
    disk = 3.14159265 / 4.0
    lost = {compensation: (1.0 - float(of.image({}).pixels.mean(dtype=float))) / disk for compensation, of in jobs.items()}
    return lost, median(seconds[True]) / median(seconds[False])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--device")
    parser.add_argument("--spp", type=int, default=64)
    options = parser.parse_args()
    print("| material | roughness | lost without | lost with | time |\n|---|---|---|---|---|")
    for name, material in KINDS.items():
        for roughness in ROUGHNESSES:
            lost, ratio = measure(material | {"roughness": roughness}, options.spp, options.device)
            print(f"| `{name}` | {roughness} | {100.0 * lost[False]:.1f} % | {100.0 * lost[True]:.2f} % | {ratio:.2f} × |", flush=True)


if __name__ == "__main__":
    main()
