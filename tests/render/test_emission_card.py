"""What shines, seen directly: sides, textures, and where emission is said, on a test card without a reflection."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from lumiere.film.image import Image
from tests.render.card import UP, Card, Cell, uv, write_exr
from tests.render.scenes import Json

Array = np.ndarray

TEXELS = np.random.default_rng(4).random((4, 4, 3)) * 5.0
RADIANCE = np.array([3.0, 2.0, 0.5])
DOWN = [{"scale": 0.5}, {"rotate": {"axis": [1, 0, 0], "angle": 90}}]


def lamp(transform: list[Json], **keys: object) -> Json:
    return {"type": "rectangle", "transform": transform, "emission": list(RADIANCE)} | keys


def all_of(value: Array | float) -> object:
    return lambda at: np.broadcast_to(value, (len(at), 3))


def nearest(at: Array) -> Array:
    u, v = uv(at).T
    return TEXELS[::-1][np.floor(4.0 * v).astype(int), np.floor(4.0 * u).astype(int)]


def cells(folder: Path) -> dict[str, Cell]:
    said = {"type": "lambert", "emission": list(RADIANCE)}
    image = {"type": "image", "file": str(folder / "texels.exr"), "filter": "nearest"}
    small = [{"scale": 0.5}, *UP, {"translate": [0, 0.3, 0]}]
    return {
        "front": Cell([lamp(UP)], all_of(RADIANCE)),
        "back": Cell([lamp(DOWN)], all_of(0.0)),
        "back of both": Cell([lamp(DOWN, emission_sides="both")], all_of(RADIANCE)),
        "front of both": Cell([lamp(UP, emission_sides="both")], all_of(RADIANCE)),
        "by the material": Cell([{"type": "rectangle", "transform": UP, "material": said}], all_of(RADIANCE)),
        "the shape's own in place of the material's": Cell([lamp(UP, material={"type": "mirror", "emission": [9, 9, 9]})], all_of(RADIANCE)),
        "sides by the material": Cell([{"type": "rectangle", "transform": DOWN, "material": said | {"emission_sides": "both"}}], all_of(RADIANCE)),
        "the shape's sides in place of the material's": Cell(
            [{"type": "rectangle", "transform": DOWN, "material": said | {"emission_sides": "both"}, "emission_sides": "front"}], all_of(0.0)),
        "mirrored": Cell([lamp([{"scale": [-0.5, 0.5, 0.5]}, *UP[1:]])], all_of(RADIANCE)),
        "picture": Cell([lamp(UP, emission=image)], nearest),
        "picture times a factor": Cell([lamp(UP, emission=image | {"factor": [2, 1, 0.5]})], lambda at: nearest(at) * (2, 1, 0.5)),
        "checker": Cell([lamp(UP, emission={"type": "checker", "a": 2, "b": 0, "scale": 2})],
                        lambda at: np.where(np.floor(2.0 * uv(at)).sum(axis=1)[:, None] % 2 == 0, 2.0, 0.0) * np.ones(3)),
        "disk": Cell([{"type": "disk", "normal": [0, 1, 0], "radius": 0.5, "emission": list(RADIANCE)}],
                     lambda at: np.where(np.hypot(at[:, 0], at[:, 2])[:, None] <= 0.5, RADIANCE, 0.0)),
        "sphere": Cell([{"type": "sphere", "radius": 0.5, "emission": list(RADIANCE)}],
                       lambda at: np.where(np.hypot(at[:, 0], at[:, 2])[:, None] <= 0.5, RADIANCE, 0.0)),
        "behind something black": Cell([lamp(UP), {"type": "rectangle", "transform": small, "material": {"type": "lambert", "albedo": 0}}],
                                       lambda at: np.where(np.abs(at[:, [0, 2]]).max(axis=1)[:, None] < 0.25, 0.0, RADIANCE)),
        "unseen": Cell([lamp(UP), lamp(small, emission=7, visible={"camera": False})], all_of(RADIANCE)),
    }


CELLS = cells(Path())


@cache
def rendered(device: cl.Device, folder: Path) -> tuple[Card, Image]:
    card = Card(cells(folder), columns=4)
    return card, card.render(device, {"integrator": {"max_depth": 0}, "lights": []}, spp=2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("emission")
    write_exr(path / "texels.exr", TEXELS)
    return path


@pytest.mark.parametrize("name", CELLS)
def test_cell(device: cl.Device, folder: Path, name: str) -> None:
    card, image = rendered(device, folder)
    card.check(image, name)
