"""Every reference scene on every OpenCL device: the table of docs/devices.md.

    python tools/references.py [--spp 64] [--device NAME …] [--scenes FOLDER …]

For each scene: the difference of the picture's mean from the converged reference's, and z over blocks of 8 × 8 pixels, with the variance of our mean,
the reference's standard error and its float rounding. A correct renderer has |mean of z| well below 1 and a standard deviation of about 1 or, with
Sobol samples, whose variance is overestimated by the samples' own, less.

All are rendered without energy compensation: the lobes of the renderers that made the references are the textbook's, of single scattering.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

import lumiere
from lumiere.device.select import list_devices
from lumiere.imagefile import read_image
from lumiere.scene.model import Scene

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = [ROOT / "tests" / "refs", ROOT.parent / "shared" / "refs"]


def block_sums(image: np.ndarray, size: int = 8) -> np.ndarray:
    """Sums over blocks of ``size`` × ``size`` pixels of (h, w, c); what is over at the right and bottom is left out."""
    height, width = image.shape[0] // size * size, image.shape[1] // size * size
    return image[:height, :width].reshape(height // size, size, width // size, size, -1).sum(axis=(1, 3))


def compare(image: lumiere.Image, reference: np.ndarray, stderr: np.ndarray) -> tuple[float, np.ndarray]:
    """Largest relative difference of a channel's mean, and z of each block and channel."""
    difference = image.pixels.astype(np.float64) - reference
    # The reference's float32 sums are rounded alike in neighbouring pixels: that does not average out over a block.
    rounding = 1e-6 * block_sums(np.abs(reference))
    z = block_sums(difference) / np.sqrt(block_sums(image.variance + stderr**2) + rounding**2 + 1e-30)
    return float(np.abs(image.pixels.mean(axis=(0, 1)) / reference.mean(axis=(0, 1)) - 1.0).max()), z


def scenes(folders: list[Path]) -> dict[str, Path]:
    """Scene files that have a reference beside them, by name; the first folder that has a name wins."""
    found: dict[str, Path] = {}
    for folder in folders:
        for path in sorted(folder.glob("*.json")):
            if path.with_suffix(".exr").is_file():
                found.setdefault(path.stem, path)
    return found


def load(path: Path) -> Scene:
    """The scene as the renderers of the references understood it: its rough surfaces lose what meets their facets more than once."""
    scene = lumiere.load(path)
    return replace(scene, integrator=replace(scene.integrator, energy_compensation=False))


def row(name: str, path: Path, device: int, spp: int) -> str:
    """One row of the table."""
    try:
        image = lumiere.render(load(path), spp=spp, device=device)
    except lumiere.SceneError as error:
        return f"| {name} | {str(error).rpartition(': ')[0].rpartition(': ')[2]}: not supported yet | | | | |"
    reference = read_image(path.with_suffix(".exr"))[..., :3].astype(np.float64)
    stderr = read_image(path.with_suffix(".stderr.exr"))[..., :3].astype(np.float64)
    worst, z = compare(image, reference, stderr)
    return (f"| {name} | {100.0 * worst:.3f} % | {z.mean():+.2f} | {z.std():.2f} | {np.abs(z).max():.1f} "
            f"| {image.record['samples_per_second'] / 1e6:.2f} |")


def main() -> None:
    parser = argparse.ArgumentParser(description="Render every reference scene on every OpenCL device.")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--device", nargs="*", help="parts of device or platform names (default: all)")
    parser.add_argument("--scenes", type=Path, nargs="*", default=FOLDERS, help="folders of reference scenes")
    arguments = parser.parse_args()
    for info in list_devices():
        if info.error or (arguments.device and not any(info.matches(text) for text in arguments.device)):
            continue
        print(f"\n**{info.name.strip()}** ({info.platform}, {info.driver}), {arguments.spp} spp\n")
        print("| scene | mean off by at most | mean of z | deviation of z | largest \\|z\\| | Msamples/s |\n|---|---|---|---|---|---|")
        for name, path in scenes(arguments.scenes).items():
            print(row(name, path, info.index, arguments.spp), flush=True)


if __name__ == "__main__":
    main()
