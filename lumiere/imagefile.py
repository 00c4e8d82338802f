"""Pictures from files and from memory, as texels."""

from __future__ import annotations

import contextlib
import logging
import os
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from lumiere.errors import SceneError

MAX_TEXELS = 2**28
"""Texels of the largest picture that is read: 16,384 × 16,384."""

_LOG = logging.getLogger("lumiere")
_STDERR = threading.Lock()


def read_image(path: str | os.PathLike[str]) -> np.ndarray:
    """(h, w, c) of a PNG, JPEG, HDR, EXR, TIFF or other file that OpenImageIO knows; row 0 at the top, c from 1 to 4.

    8-bit integers stay uint8; all else is float32, integers scaled to [0, 1]. Values are as stored: not decoded, and not multiplied by alpha.
    Of more than four channels R, G, B and A are taken. What lies outside an EXR's data window is 0. Values that are not finite are 0,
    and a warning says how many there were. Raises SceneError for a file that is not a whole picture.
    """
    try:
        with Path(path).open("rb"):
            pass
    except OSError as error:
        raise SceneError(f"{path}: found no picture that can be read ({error.strerror}), expected a file", path) from None
    try:
        with _quiet():
            pixels = _read(Path(path))
        return as_pixels(pixels, str(path))
    except SceneError as error:
        error.about = path
        raise


def as_pixels(image: Any, name: str) -> np.ndarray:
    """(h, w, c) uint8 or float32, as ``read_image`` returns it, of an array or a Pillow image called ``name``; row 0 at the top.

    An array is (h, w) or (h, w, c) with c from 1 to 4, of floats, uint8, or uint16. Raises SceneError for anything else.
    """
    if hasattr(image, "getbands"):
        image = _plain_mode(image)
    pixels = np.asarray(image)
    if pixels.ndim == 2:
        pixels = pixels[..., None]
    if pixels.ndim != 3 or not 1 <= pixels.shape[2] <= 4 or pixels.size == 0:
        raise SceneError(f"{name}: found a picture of shape {pixels.shape}, expected (height, width, 1 to 4)")
    _check_size(pixels.shape[1], pixels.shape[0], name)
    if pixels.dtype == np.uint8:
        return pixels
    if pixels.dtype == np.uint16:
        return pixels.astype(np.float32) / np.float32(65535.0)
    if not np.issubdtype(pixels.dtype, np.floating):
        raise SceneError(f"{name}: found texels of type {pixels.dtype}, expected uint8, uint16 or floats")
    with np.errstate(over="ignore"):  # a float64 beyond float32 becomes infinite, and is counted below
        pixels = pixels.astype(np.float32, copy=False)
    bad = ~np.isfinite(pixels)
    if bad.any():
        _LOG.warning("%s: %d of %d values are NaN or infinite; they are taken as 0", name, np.count_nonzero(bad), pixels.size)
        pixels = np.where(bad, np.float32(0.0), pixels)
    return pixels


def _read(path: Path) -> np.ndarray:
    import OpenImageIO

    config = OpenImageIO.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)  # else PNG's colours come multiplied by alpha
    file = OpenImageIO.ImageInput.open(str(path), config)
    if file is None:
        raise SceneError(f"{path}: found no picture that can be read ({_line(OpenImageIO.geterror())}), expected PNG, JPEG, HDR, EXR or TIFF")
    spec = file.spec()
    _check_size(spec.width, spec.height, str(path))
    _check_size(spec.full_width, spec.full_height, str(path))
    if spec.depth > 1 or spec.full_depth > 1 or spec.deep:
        raise SceneError(f"{path}: found a volume or a deep picture, expected a flat one")
    stored = "uint8" if spec.format == OpenImageIO.TypeUInt8 else "float"
    pixels = file.read_image(0, 0, 0, spec.nchannels, stored)
    if pixels is None or file.has_error:
        raise SceneError(f"{path}: found a damaged picture ({_line(file.geterror())}), expected a whole one")
    return _in_display_window(pixels[..., _channels(spec.channelnames)], spec)


def _channels(names: tuple[str, ...]) -> list[int]:
    """Places of the channels to take of those in a file."""
    for wanted in (("R", "G", "B"), ("Y",)):
        if all(name in names for name in wanted):
            return [names.index(name) for name in (*wanted, "A") if name in names]
    return list(range(min(len(names), 4)))


def _in_display_window(pixels: np.ndarray, spec: Any) -> np.ndarray:
    """The display window's pixels, 0 where the file holds none."""
    x, y = spec.x - spec.full_x, spec.y - spec.full_y
    if (x, y, spec.width, spec.height) == (0, 0, spec.full_width, spec.full_height):
        return pixels
    whole = np.zeros((spec.full_height, spec.full_width, pixels.shape[2]), dtype=pixels.dtype)
    x0, y0, x1, y1 = max(x, 0), max(y, 0), min(x + spec.width, spec.full_width), min(y + spec.height, spec.full_height)
    if x0 < x1 and y0 < y1:
        whole[y0:y1, x0:x1] = pixels[y0 - y:y1 - y, x0 - x:x1 - x]
    return whole


def _check_size(width: int, height: int, name: str) -> None:
    if not 0 < width * height <= MAX_TEXELS:
        raise SceneError(f"{name}: found a picture of {width} × {height}, expected at most {MAX_TEXELS:,} texels (16,384 × 16,384)")


def _plain_mode(image: Any) -> Any:
    """A Pillow image whose array holds L, LA, RGB, RGBA, floats or 16-bit integers."""
    if image.mode in ("P", "PA"):
        return image.convert("RGBA" if "transparency" in image.info or image.mode == "PA" else "RGB")
    if image.mode in ("1", "CMYK", "YCbCr", "HSV", "LAB", "RGBa", "La", "RGBX"):
        return image.convert({"1": "L", "RGBa": "RGBA", "La": "LA"}.get(image.mode, "RGB"))
    return image


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keeps libraries from writing to standard error, since libpng tells there what the caller is told anyway."""
    with _STDERR:
        try:
            kept = os.dup(2)
        except OSError:  # no standard error to keep quiet
            yield
            return
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        os.close(nowhere)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def _line(text: str) -> str:
    """The first line of OpenImageIO's explanation."""
    return next((line.strip() for line in text.splitlines() if line.strip()), "no reason given")
