"""A test card: cells of a metre seen from above, each with something else in it, of which every pixel is known. One render tests them all."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pyopencl as cl

from lumiere.film.image import Image
from tests.render.scenes import POINT_FILTER, Json, assert_exact, assert_mean, from_above, render

Array = np.ndarray

PITCH, PIXELS_A_METRE = 1.5, 8
MARGIN = (PITCH - 1.0) / 2.0
UP = [{"scale": 0.5}, {"rotate": {"axis": [1, 0, 0], "angle": -90}}]
"""Brings a rectangle to one metre square that faces up, its uv upright in the picture."""


@dataclass
class Cell:
    """Shapes whose transforms end in a cell's own space (x to the right, y up out of the picture, z down it, the cell within ±½), and the radiance
    expected at points (n, 3) of its floor, as (n, 3): of every sample, but for so many roundings, or, where it is ``chance``, in the mean.

    Roundings are of the value itself, or of the largest of the ``terms`` that it is a sum of, which a small sum carries too.
    """

    shapes: list[Json]
    expected: Callable[[Array], Array]
    roundings: int = 64
    chance: bool = False
    terms: float = 0.0


@dataclass
class Card:
    """Cells by name, in rows of ``columns``."""

    cells: dict[str, Cell]
    columns: int
    origins: dict[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        rows = -(-len(self.cells) // self.columns)
        for number, name in enumerate(self.cells):
            row, column = divmod(number, self.columns)
            self.origins[name] = PITCH * np.array([column - (self.columns - 1) / 2.0, 0.0, row - (rows - 1) / 2.0])
        self.width, self.height = (round(n * PITCH * PIXELS_A_METRE) for n in (self.columns, rows))

    def geometry(self) -> list[Json]:
        return [shape | {"transform": [*shape.get("transform", []), {"translate": list(self.origins[name])}]}
                for name, cell in self.cells.items() for shape in cell.shapes]

    def render(self, device: cl.Device, scene: Json, spp: int = 1) -> Image:
        rows = self.height / PIXELS_A_METRE
        film = {"width": self.width, "height": self.height, "filter": POINT_FILTER}
        return render(device, {"camera": from_above(20.0, rows), "film": film, "sampler": {"type": "independent", "spp": spp},
                               "geometry": self.geometry()} | scene)

    def pixels(self, name: str) -> tuple[slice, slice]:
        """Rows and columns of the pixels inside the metre of a cell."""
        number = list(self.cells).index(name)
        row, column = divmod(number, self.columns)
        inset = round(MARGIN * PIXELS_A_METRE)
        step = round(PITCH * PIXELS_A_METRE)
        return (slice(row * step + inset, row * step + inset + PIXELS_A_METRE), slice(column * step + inset, column * step + inset + PIXELS_A_METRE))

    def check(self, image: Image, name: str) -> None:
        cell, part, expected = self.cells[name], self.pixels(name), self.cells[name].expected(points())
        if cell.chance:
            inner = Image(pixels=image.pixels[part], variance=image.variance[part], record=image.record)
            assert_mean(inner, expected.reshape(inner.pixels.shape))
        else:
            assert_exact(image.pixels[part].reshape(-1, 3), expected, cell.roundings, terms=cell.terms)


def points() -> Array:
    """(64, 3): the centres of a cell's pixels on its floor."""
    at = (np.arange(PIXELS_A_METRE) + 0.5) / PIXELS_A_METRE - 0.5
    x, z = np.meshgrid(at, at)
    return np.stack([x.ravel(), np.zeros(x.size), z.ravel()], axis=1)


def uv(at: Array) -> Array:
    """uv of points on the rectangle ``UP``."""
    return np.stack([at[:, 0] + 0.5, 0.5 - at[:, 2]], axis=1)


def write_exr(path: Path, pixels: Array) -> str:
    """(h, w, 3) as a linear float EXR, row 0 at the top."""
    import OpenImageIO

    file = OpenImageIO.ImageOutput.create(str(path))
    file.open(str(path), OpenImageIO.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "float"))
    file.write_image(np.ascontiguousarray(pixels, np.float32))
    file.close()
    return str(path)


def write_png(path: Path, pixels: Array) -> str:
    """(h, w, 4) uint8 as a PNG of colour type 6 without any colour space, row 0 at the top."""
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in np.ascontiguousarray(pixels, np.uint8))

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
    return str(path)
