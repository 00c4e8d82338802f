"""Pictures that lie inside mesh files."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from lumiere.errors import LumiereError
from lumiere.meshfile.part import MeshFileError

SUFFIXES = {b"\x89PNG": ".png", b"\xff\xd8\xff": ".jpg", b"RIFF": ".webp"}
"""What the formats that glTF allows begin with."""


def decode(data: bytes, what: str) -> np.ndarray:
    """(h, w, c) uint8 or float32, row 0 at the top, of a PNG, JPEG or WebP file's bytes. Raises MeshFileError naming ``what``."""
    from lumiere.imagefile import read_image

    suffix = next((suffix for start, suffix in SUFFIXES.items() if data.startswith(start)), None)
    if suffix is None:
        raise MeshFileError(f"found {what} that is neither PNG, JPEG nor WebP, expected one of these")
    with tempfile.TemporaryDirectory(prefix="lumiere-") as folder:  # OpenImageIO reads files only
        path = Path(folder) / f"picture{suffix}"
        path.write_bytes(data)
        try:
            return read_image(path)
        except LumiereError:
            raise MeshFileError(f"found {what} of {len(data)} bytes that cannot be decoded, expected a whole one") from None
