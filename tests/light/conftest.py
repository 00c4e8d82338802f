"""A small sky."""

from __future__ import annotations

import numpy as np
import OpenImageIO
import pytest

WIDTH, HEIGHT = 24, 12


def sky_pixels() -> np.ndarray:
    """(HEIGHT, WIDTH, 3) float32: noise, a black band, and one very bright pixel, as skies with a sun have."""
    pixels = np.random.default_rng(7).random((HEIGHT, WIDTH, 3)).astype(np.float32)
    pixels[7:, 3:12] = 0.0
    pixels[3, 16] = (8e4, 6e4, 4e4)
    return pixels


@pytest.fixture(scope="session")
def sky(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Name of a lat-long EXR that holds ``sky_pixels``."""
    path = tmp_path_factory.mktemp("sky") / "sky.exr"
    file = OpenImageIO.ImageOutput.create(str(path))
    file.open(str(path), OpenImageIO.ImageSpec(WIDTH, HEIGHT, 3, "float"))
    file.write_image(sky_pixels())
    file.close()
    return str(path)
