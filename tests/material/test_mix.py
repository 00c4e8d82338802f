"""Mixes: their pictures are the mixtures of their parts' pictures, however deep."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl
import pytest

import lumiere
from lumiere.compile.scene import compile_scene
from lumiere.errors import SceneError
from lumiere.film.image import Image

GREY = {"type": "lambert", "albedo": 0.2}
RED = {"type": "lambert", "albedo": [0.9, 0.1, 0.1]}
METAL = {"type": "conductor", "roughness": 0.4, "metal": "gold"}


def scene(material: dict[str, Any], **film: Any) -> dict[str, Any]:
    """A sphere that shades itself a little, in a sky that is half as bright below."""
    return {"scene": {
        "film": {"width": 24, "height": 24, **film}, "sampler": {"seed": 5},
        "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0], "fov": 30},
        "geometry": [{"type": "sphere", "position": [0, 0, 0], "radius": 1, "material": material}],
        "lights": [{"type": "environment", "radiance": 0.5}, {"type": "point", "position": [3, 3, 3], "intensity": 20}]}}


def picture(device: cl.Device, material: dict[str, Any], spp: int = 64, **film: Any) -> Image:
    return lumiere.render(scene(material, **film), spp=spp, device=device.name)


def assert_mixture(mixed: Image, parts: list[tuple[float, Image]]) -> None:
    """z-test of the mean over the picture, channel by channel."""
    difference = (mixed.pixels - sum(weight * part.pixels for weight, part in parts)).mean(axis=(0, 1))
    variance = (mixed.variance + sum(weight**2 * part.variance for weight, part in parts)).mean(axis=(0, 1)) / mixed.pixels[..., 0].size
    assert np.all(np.abs(difference) < 4.5 * np.sqrt(variance) + 1e-5)


@pytest.mark.parametrize("weight", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("other", [RED, METAL], ids=["same kind", "another kind"])
def test_a_mix_is_the_mixture(device: cl.Device, weight: float, other: dict[str, Any]) -> None:
    mixed = picture(device, {"type": "mix", "a": GREY, "b": other, "weight": weight})
    assert_mixture(mixed, [(1.0 - weight, picture(device, GREY)), (weight, picture(device, other))])


def test_mixes_in_mixes(device: cl.Device) -> None:
    inner = {"type": "mix", "a": RED, "b": {"type": "mirror"}, "weight": 0.25}
    mixed = picture(device, {"type": "mix", "a": inner, "b": METAL, "weight": 0.4})
    assert_mixture(mixed, [(0.45, picture(device, RED)), (0.15, picture(device, {"type": "mirror"})), (0.4, picture(device, METAL))])


def test_a_textured_weight(device: cl.Device) -> None:
    checker = {"type": "checker", "a": 0, "b": 1, "scale": [8, 4]}
    mixed = picture(device, {"type": "mix", "a": GREY, "b": RED, "weight": checker}, spp=16)
    expected = picture(device, {"type": "lambert", "albedo": {"type": "checker", "a": 0.2, "b": [0.9, 0.1, 0.1], "scale": [8, 4]}}, spp=16)
    assert_mixture(mixed, [(1.0, expected)])


def test_ids_are_those_of_the_object_and_its_material(device: cl.Device) -> None:
    mixed = picture(device, {"type": "mix", "a": GREY, "b": METAL}, spp=4, aovs=["object_id", "material_id", "albedo"])
    assert set(np.unique(mixed.aovs["object_id"])) <= {0.0, -1.0} and set(np.unique(mixed.aovs["material_id"])) <= {0.0, -1.0}


def test_without_mixes_nothing_is_stored_for_them() -> None:
    assert not compile_scene(lumiere.load(scene(GREY))).features.mixes
    features = compile_scene(lumiere.load(scene({"type": "mix", "a": GREY, "b": RED}))).features
    assert features.mixes and not features.textured_mixes and list(features.bsdfs) == ["lambert"]


@pytest.mark.parametrize(("mix", "complaint"), [
    ({"a": GREY}, "found no 'b'"), ({"a": GREY, "b": {**RED, "emission": 1}}, "move 'emission'"),
    ({"a": {**GREY, "opacity": 0.5}, "b": RED}, "move 'opacity'"), ({"a": GREY, "b": RED, "weight": 1.5}, "found 1.5")])
def test_complaints(mix: dict[str, Any], complaint: str) -> None:
    with pytest.raises(SceneError, match=complaint):
        lumiere.load(scene({"type": "mix", **mix}))
