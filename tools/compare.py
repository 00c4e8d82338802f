"""Compares two pictures of one scene: means, relative mean squared error, and where the noise is known, whether noise explains the difference.

    python tools/compare.py OURS.exr REFERENCE.exr [--stderr REFERENCE.stderr.exr]

The noise of a picture is its layer ``variance`` (of each pixel's mean; an AOV of the scene format), and for the second picture its standard error
may be a file of its own. Where the files say how many samples they took, the first is held to have at least the noise that the second had for
each sample. z = difference / √(sum of the variances), over the whole picture and over blocks of pixels: about normal for a renderer that is right.
The exit status says nothing about z: that is for people, and for the tests, to judge.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

Array = np.ndarray

ROUNDING = 1e-6
"""Relative error of a pixel that no variance tells: sums in float32, and how far float32 geometry moves an edge."""


@dataclass
class Comparison:
    """``a`` against ``b``. Arrays end with one value a channel; those of z are None where no variance is known."""

    mean_a: Array
    mean_b: Array
    rel_mse: float
    z_mean: Array | None = None
    """(c,) of the whole picture."""
    z_blocks: Array | None = None
    """(rows, columns, c)."""

    @property
    def relative(self) -> Array:
        """(c,) how much brighter ``a`` is in the mean: 0.01 is 1 %."""
        return (self.mean_a - self.mean_b) / np.where(self.mean_b == 0.0, 1.0, self.mean_b)

    def beyond(self, z: float) -> float:
        """Fraction of the blocks and channels whose |z| is larger."""
        return float(np.mean(np.abs(self.z_blocks) > z))


def _block_sums(pixels: Array, size: int) -> Array:
    """(⌈h / size⌉, ⌈w / size⌉, c) float64 sums over the blocks of ``size`` × ``size`` pixels of (h, w, c); those at the end may be smaller."""
    sums = pixels.astype(np.float64)
    for axis in (0, 1):
        sums = np.add.reduceat(sums, np.arange(0, pixels.shape[axis], size), axis=axis)
    return sums


def block_means(pixels: Array, size: int) -> Array:
    """Means over the blocks of ``_block_sums``."""
    return _block_sums(pixels, size) / _block_sums(np.ones_like(pixels), size)


def block_variance(variance: Array, size: int) -> Array:
    """Variances of ``block_means`` of independent pixels of these variances, (h, w, c)."""
    return _block_sums(variance, size) / np.square(_block_sums(np.ones_like(variance), size))


def compare(a: Array, b: Array, variance: Array | None = None, *, block: int = 8) -> Comparison:
    """Compares (h, w, c) pictures; ``variance`` (h, w, c) is that of their difference, pixels being independent."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    # Rousselle, Knaus & Zwicker 2011, §4: the square of the relative error, kept finite where the reference is dark.
    result = Comparison(a.mean(axis=(0, 1)), b.mean(axis=(0, 1)), float(np.mean((a - b) ** 2 / (b**2 + 1e-2))))
    if variance is not None:
        variance = variance.astype(np.float64)
        # Rounding moves all pixels the same way: it is not averaged out.
        total = variance.mean(axis=(0, 1)) / (a.shape[0] * a.shape[1]) + (ROUNDING * result.mean_b) ** 2
        blocks = block_variance(variance, block) + (ROUNDING * block_means(b, block)) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            result.z_mean = _quotient(result.mean_a - result.mean_b, np.sqrt(total))
            result.z_blocks = _quotient(block_means(a - b, block), np.sqrt(blocks))
    return result


def variance_of_difference(variance: Array, spp: int, stderr: Array, reference_spp: int) -> Array:
    """(h, w, c) variance of a picture of ``spp`` samples less a reference of ``reference_spp``, from the one's variance and the other's standard
    error.

    Where a few of many samples hold nearly all of the light, as in caustics and at the rims of blur, a picture that got none of them takes itself
    for noiseless. So each pixel has at least the variance that the reference saw, for as many samples.
    """
    return np.maximum(variance, stderr**2 * (reference_spp / spp)) + stderr**2


def _quotient(difference: Array, deviation: Array) -> Array:
    """z; 0 where both are 0."""
    return np.where(difference == 0.0, 0.0, difference / deviation)


def read(path: Path) -> tuple[dict[str, Array], int | None]:
    """Layers of an EXR, each (h, w, c) float64, ``""`` being the picture itself; and its samples a pixel, where it says."""
    import OpenImageIO

    file = OpenImageIO.ImageInput.open(str(path))
    if file is None:
        sys.exit(f"{path}: found no picture that can be read, expected an EXR")
    spec = file.spec()
    pixels = np.asarray(file.read_image(0, 0, 0, spec.nchannels, "float"), np.float64)
    layers: dict[str, list[Array]] = {}
    for number, name in enumerate(spec.channelnames):
        layers.setdefault(name.rpartition(".")[0], []).append(pixels[..., number])
    spp = spec.getattribute("lumiere:spp") or spec.getattribute("spp")
    return {name: np.stack(planes, axis=-1)[..., :3] for name, planes in layers.items()}, int(spp) if spp else None


def report(c: Comparison) -> str:
    """The comparison in words."""
    row = lambda values, form: "  ".join(format(value, form) for value in values)  # noqa: E731
    lines = [f"mean of A    {row(c.mean_a, '.6g')}", f"mean of B    {row(c.mean_b, '.6g')}", f"A / B - 1    {row(100.0 * c.relative, '+.4f')}  %",
             f"relMSE       {c.rel_mse:.6g}"]
    if c.z_mean is None:
        lines.append("z            unknown: no variance layer, and no --stderr")
    else:
        tails = ", ".join(f"|z| > {z}: {100.0 * c.beyond(z):.3f} % ({100.0 * normal:.3g} %)"
                          for z, normal in ((2, 0.0455), (3, 0.0027), (4, 6.3e-5), (5, 5.7e-7)))
        lines += [f"z of mean    {row(c.z_mean, '+.2f')}", f"z of blocks  {tails}; in brackets: normal",
                  f"             largest {np.abs(c.z_blocks).max():.2f}, root mean square {np.sqrt(np.mean(c.z_blocks ** 2)):.3f}"]
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("a", type=Path, help="a picture, EXR")
    parser.add_argument("b", type=Path, help="what it should be, EXR")
    parser.add_argument("--stderr", type=Path, help="standard error of each pixel of B, EXR")
    parser.add_argument("--block", type=int, default=8, metavar="N", help="z of blocks of N × N pixels (default 8)")
    options = parser.parse_args()
    (a, a_spp), (b, b_spp) = read(options.a), read(options.b)
    if a[""].shape != b[""].shape:
        sys.exit(f"found {a[''].shape[1]} × {a[''].shape[0]} and {b[''].shape[1]} × {b[''].shape[0]} pixels, expected two of a size")
    a_variance, b_variance = a.get("variance"), b.get("variance")
    if options.stderr:
        b_variance = read(options.stderr)[0][""] ** 2
    if a_variance is not None and b_variance is not None and a_spp and b_spp:
        variance = variance_of_difference(a_variance, a_spp, np.sqrt(b_variance), b_spp)
    else:
        known = [v for v in (a_variance, b_variance) if v is not None]
        variance = sum(known[1:], known[0]) if known else None
    print(report(compare(a[""], b[""], variance, block=options.block)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
