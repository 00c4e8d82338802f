"""Pictures as files: OpenEXR, PNG and JPEG."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lumiere.errors import UsageError
from lumiere.film.atomic import check_writable, replacing
from lumiere.film.encode import encode8
from lumiere.film.record import record_json

if TYPE_CHECKING:
    from lumiere.film.image import Image

LAYER_CHANNELS: dict[str, tuple[str, ...]] = {
    "normal": ("X", "Y", "Z"), "position": ("X", "Y", "Z"), "depth": ("Z",), "uv": ("U", "V"), "material_id": ("id",), "object_id": ("id",),
    "sample_count": ("N",)}
"""Channel names within an EXR layer; a layer not named here holds R, G, B, or Y where it has one channel."""

RECORD_KEYS = ("scene", "scene_hash", "version", "device", "driver", "spp", "seed")
"""The record's entries that are attributes of their own, ``lumiere:KEY``, next to the whole as JSON in ``lumiere:record``."""

_REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)


JPEG_MAX_SIZE = 65500
"""Largest width and height that libjpeg takes."""


def check_output(path: str | os.PathLike[str], size: tuple[int, int] | None = None) -> None:
    """Raises UsageError where ``Image.save(path)`` could not work: suffix, ``size`` (width, height), folder or rights. Leaves nothing behind."""
    _writer(path)
    if size is not None and max(size) > JPEG_MAX_SIZE and Path(path).suffix.lower() in (".jpg", ".jpeg"):
        raise UsageError(f"cannot write {path}: found {size[0]} × {size[1]} pixels, expected at most {JPEG_MAX_SIZE} each way in a JPEG")
    check_writable(path)


def write(image: Image, path: str | os.PathLike[str], exposure: float, tonemap: str) -> None:
    """``Image.save``."""
    check_output(path, (image.width, image.height))
    writer = _writer(path)
    with replacing(path) as temporary:
        writer(image, temporary, exposure, tonemap)


def _writer(path: str | os.PathLike[str]) -> Any:
    suffix = Path(path).suffix.lower()
    if suffix not in _WRITERS:
        found = f"ends in '{suffix}'" if suffix else "has no suffix"
        raise UsageError(f"cannot write {path}: its name {found}, expected one of {', '.join(_WRITERS)}")
    return _WRITERS[suffix]


def _layers(image: Image) -> list[tuple[str, np.ndarray]]:
    """Channel names and (h, w) arrays: R, G, B, then each AOV's."""
    channels = [(name, image.pixels[..., c]) for c, name in enumerate("RGB")]
    for layer, values in image.aovs.items():
        planes = values[..., None] if values.ndim == 2 else values
        names = LAYER_CHANNELS.get(layer, ("Y",) if planes.shape[2] == 1 else ("R", "G", "B"))
        if len(names) != planes.shape[2]:
            raise ValueError(f"layer '{layer}' has {planes.shape[2]} channels, expected {len(names)}")
        channels += [(f"{layer}.{name}", planes[..., c]) for c, name in enumerate(names)]
    return channels


def _write_exr(image: Image, path: Path, exposure: float, tonemap: str) -> None:
    """Radiance unchanged: ``exposure`` and ``tonemap`` are for screens. The data window is the crop, the display window the whole picture."""
    import OpenImageIO

    layers = _layers(image)
    height, width = image.pixels.shape[:2]
    spec = OpenImageIO.ImageSpec(width, height, len(layers), "float")
    spec.channelnames = tuple(name for name, _ in layers)
    spec.x, spec.y = image.crop[:2]
    spec.full_x, spec.full_y = 0, 0
    spec.full_width, spec.full_height = image.full_size
    spec.attribute("compression", "zip")
    spec.attribute("chromaticities", OpenImageIO.TypeDesc("float[8]"), _REC709)
    spec.attribute("lumiere:record", record_json(image.record))
    for key in RECORD_KEYS:
        if key in image.record:
            spec.attribute(f"lumiere:{key}", str(image.record[key]))
    out = OpenImageIO.ImageOutput.create("openexr")
    pixels = np.stack([plane for _, plane in layers], axis=-1, dtype=np.float32, casting="unsafe")
    written = out.open(str(path), spec) and out.write_image(pixels)
    if not (written and out.close()):
        raise OSError(" ".join(out.geterror().split()) or "OpenImageIO gave no reason")


def _write_8bit(image: Image, path: Path, exposure: float, tonemap: str) -> None:
    # Encoded in memory by Pillow, since on a full disk OpenImageIO's PNG loses data unnoticed and its JPEG ends the process.
    import PIL.Image
    import PIL.PngImagePlugin

    encoded = io.BytesIO()
    picture = PIL.Image.fromarray(encode8(image.pixels, exposure, tonemap))
    if path.suffix.lower() == ".png":
        chunks = PIL.PngImagePlugin.PngInfo()
        chunks.add(b"sRGB", b"\0")  # perceptual intent (PNG specification, §11.3.2.5)
        # Level 4 takes half the time of zlib's default for 2 to 5 % more bytes, and none more where there is noise.
        picture.save(encoded, "PNG", pnginfo=chunks, compress_level=4)
    else:
        picture.save(encoded, "JPEG", quality=95, subsampling="4:4:4")
    path.write_bytes(encoded.getbuffer())


_WRITERS = {".exr": _write_exr, ".png": _write_8bit, ".jpg": _write_8bit, ".jpeg": _write_8bit}
