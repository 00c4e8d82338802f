"""The same scene and seed give the same bits, however the work is cut up."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pyopencl as cl
import pytest

import lumiere.rendering
from lumiere.film.image import Image
from lumiere.wavefront.policy import policy_for
from tests.render.scenes import Json, render

WIDTH, HEIGHT, SPP = 37, 21, 6
AOVS = ["albedo", "normal", "depth", "position", "uv", "material_id", "object_id", "variance", "direct", "indirect", "emission"]

SCENE: Json = {
    "camera": {"type": "thin_lens", "position": [0, 0, 3.4], "look_at": [0, 0, 0], "fov": 30, "aperture_radius": 0.05, "focus_distance": 3},
    "film": {"width": WIDTH, "height": HEIGHT, "aovs": AOVS, "filter": {"type": "tent"}},
    "sampler": {"spp": SPP, "seed": 7},
    "integrator": {"russian_roulette_depth": 2},
    "materials": {"white": {"type": "lambert"}, "tiles": {"type": "lambert", "albedo": {"type": "checker", "a": 0.2, "b": 0.9, "scale": 5}},
                  "glass": {"type": "dielectric"}, "veil": {"type": "lambert", "opacity": 0.5}},
    "geometry": [
        {"type": "rectangle", "transform": [{"rotate": {"axis": [1, 0, 0], "angle": -90}}, {"translate": [0, -1, 0]}], "material": "tiles"},
        {"type": "rectangle", "transform": [{"translate": [0, 0, -1]}], "material": "white"},
        {"type": "sphere", "position": [0.4, -0.5, 0.2], "radius": 0.5, "material": "glass"},
        {"type": "rectangle", "transform": [{"scale": 0.4}, {"translate": [-0.4, -0.3, 0.6]}], "material": "veil"},
        {"type": "rectangle", "transform": [{"scale": 0.3}, {"rotate": {"axis": [1, 0, 0], "angle": 90}}, {"translate": [0, 1, 0]}], "emission": 9}],
    "lights": [{"type": "environment", "radiance": 0.1}]}


def with_policy(monkeypatch: pytest.MonkeyPatch, **changes: Any) -> None:
    monkeypatch.setattr(lumiere.rendering, "policy_for", lambda *arguments: replace(policy_for(*arguments), **changes))


def layers(image: Image) -> dict[str, np.ndarray]:
    return image.aovs | {"radiance": image.pixels, "its variance": image.variance}


def assert_same_bits(a: Image, b: Image) -> None:
    for name, values in layers(a).items():
        other = layers(b)[name]
        same = values.tobytes() == other.tobytes()
        assert same, f"{name} differs in {np.count_nonzero(values != other)} of {values.size} values"


@pytest.fixture(scope="module")
def usual(device: cl.Device) -> Image:
    return render(device, SCENE)


def test_again(device: cl.Device, usual: Image) -> None:
    assert_same_bits(render(device, SCENE), usual)


def test_another_seed_is_another_picture(device: cl.Device, usual: Image) -> None:
    """Else the tests here would compare pictures that cannot differ."""
    other = render(device, SCENE, seed=8)
    assert np.mean(other.pixels != usual.pixels) > 0.5


@pytest.mark.parametrize("slots", [256, 768, 1024, 1 << 15])
def test_paths_in_flight(device: cl.Device, usual: Image, monkeypatch: pytest.MonkeyPatch, slots: int) -> None:
    group = policy_for(device, 1, 1, 1).work_group
    with_policy(monkeypatch, slots=-(-slots // group) * group)
    image = render(device, SCENE)
    assert image.record["paths_in_flight"] != usual.record["paths_in_flight"] or slots == 1 << 15
    assert_same_bits(image, usual)


@pytest.mark.parametrize("batch", [1, 100, WIDTH * HEIGHT - 1, WIDTH * HEIGHT, 2 * WIDTH * HEIGHT + 5, 1 << 20])
def test_batch_size(device: cl.Device, usual: Image, monkeypatch: pytest.MonkeyPatch, batch: int) -> None:
    """Parts of one sample of the picture, whole samples, several, all at once."""
    scene = SCENE
    if batch == 1:
        # A sample at a time, of a picture small enough for that.
        scene = SCENE | {"film": SCENE["film"] | {"crop": [30, 14, 33, 17]}}
    with_policy(monkeypatch, batch=batch)
    image = render(device, scene)
    x0, y0, x1, y1 = image.crop
    for name, values in layers(image).items():
        assert values.tobytes() == np.ascontiguousarray(layers(usual)[name][y0:y1, x0:x1]).tobytes(), name


@pytest.mark.parametrize("rounds", [2, 6, 40])
def test_rounds_between_looks(device: cl.Device, usual: Image, monkeypatch: pytest.MonkeyPatch, rounds: int) -> None:
    with_policy(monkeypatch, rounds=rounds)
    assert_same_bits(render(device, SCENE), usual)


@pytest.mark.parametrize("compacted", [False, True], ids=["dense", "compacted"])
def test_queue_policy(device: cl.Device, usual: Image, monkeypatch: pytest.MonkeyPatch, compacted: bool) -> None:
    """Tags on all slots or lists of slots; with few slots too, so that each is used again and again."""
    leave = policy_for(device, 1, 1, 1).groups_leave and compacted
    for slots in (usual.record["paths_in_flight"], 256):
        with_policy(monkeypatch, compacted=compacted, groups_leave=leave, slots=slots)
        assert_same_bits(render(device, SCENE), usual)


@pytest.mark.parametrize("crop", [(0, 0, 37, 21), (5, 3, 30, 20), (36, 20, 37, 21), (8, 8, 16, 16), (0, 7, 37, 9)])
def test_crop(device: cl.Device, usual: Image, crop: tuple[int, int, int, int]) -> None:
    image = render(device, SCENE, crop=crop)
    x0, y0, x1, y1 = crop
    assert image.crop == crop and image.full_size == (WIDTH, HEIGHT)
    for name, values in layers(image).items():
        assert values.tobytes() == np.ascontiguousarray(layers(usual)[name][y0:y1, x0:x1]).tobytes(), name


@pytest.mark.parametrize("count", [1, 2, 4])
def test_stopped_early(device: cl.Device, count: int) -> None:
    """A render stopped after some samples is the render of as many; Sobol's come in the same order whatever their number."""
    looks = iter(range(100))
    stopped = render(device, SCENE, spp=1000, stop=lambda: next(looks) >= count)
    taken = stopped.record["spp"]
    assert 1 <= taken < 1000
    assert_same_bits(stopped, render(device, SCENE, spp=taken))


def test_time_limit(device: cl.Device) -> None:
    limited = render(device, SCENE, spp=1 << 20, time_limit=0.2)
    taken = limited.record["spp"]
    assert 1 <= taken < 1 << 20
    assert_same_bits(limited, render(device, SCENE, spp=taken))


def test_stratified_sampler(device: cl.Device, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whose strata depend on the number of samples."""
    scene = SCENE | {"sampler": SCENE["sampler"] | {"type": "stratified"}}
    first = render(device, scene)
    with_policy(monkeypatch, slots=256, batch=500)
    assert_same_bits(render(device, scene), first)
