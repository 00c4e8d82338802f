"""Dielectrics that overlap, by priority: the same light as from bodies that fit, whose indices are relative to each other."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

import lumiere
from lumiere.compile.scene import compile_scene
from lumiere.errors import SceneError
from tests.render.scenes import Json, assert_mean, render

WHITE = [{"type": "environment", "radiance": 1}]
HEAD_ON = {"type": "orthographic", "position": [0, 0, 9], "look_at": [0, 0, 0], "height": 1}
FILM = {"width": 16, "height": 16}


def glass(priority: int, ior: float, **keys: object) -> Json:
    return {"type": "dielectric", "priority": priority, "ior": ior, **keys}


def slab(back: float, front: float, material: Json) -> Json:
    return {"type": "box", "min": [-5, -5, back], "max": [5, 5, front], "material": material}


def seen(device: cl.Device, geometry: list[Json], spp: int = 256, **keys: object) -> lumiere.Image:
    scene = {"camera": HEAD_ON, "film": FILM, "sampler": {"type": "independent", "spp": spp}, "integrator": {"max_depth": 64, "russian_roulette_depth": None},
             "geometry": geometry, "lights": WHITE, **keys}
    return render(device, scene)


def mirrored(a: float, b: float) -> float:
    """Part of the light that is reflected head on between indices a and b (Fresnel 1823)."""
    return ((a - b) / (a + b)) ** 2


def reflected(parts: list[float]) -> float:
    """Of a stack of boundaries that reflect such parts, with all reflections in between."""
    total = 0.0
    for part in reversed(parts):
        total = part + (1.0 - part) ** 2 * total / (1.0 - part * total)
    return total


def black(z: float, emission: float = 0.0) -> Json:
    """A wall that takes all light, before the white sky behind it; what is seen is what the boundaries before it reflect, and what it emits itself."""
    return {"type": "rectangle", "transform": [{"scale": 5}, {"translate": [0, 0, z]}],
            "material": {"type": "lambert", "albedo": 0, "emission": emission}}


@pytest.mark.parametrize("roughness", [0.0, 0.005])
@pytest.mark.parametrize(("first", "second", "border"), [(2, 1, 1.0), (1, 2, 1.2), (1, 1, 1.2)], ids=["front wins", "back wins", "equal"])
def test_overlap_reflects_like_a_fit(device: cl.Device, first: int, second: int, border: float, roughness: float) -> None:
    """Front to back: air, glass, water, black; glass and water overlap between 1 and 1.2. With the border where the winner ends."""
    image = seen(device, [slab(1.0, 2.0, glass(first, 1.5, roughness=roughness)), slab(-1.0, 1.2, glass(second, 1.33)), black(0.0)])
    assert_mean(image, np.full(3, reflected([mirrored(1.0, 1.5), mirrored(1.5, 1.33)])))


def test_a_body_inside_another_is_not_there(device: cl.Device) -> None:
    image = seen(device, [slab(0.5, 2.0, glass(2, 1.5)), slab(0.8, 1.5, glass(1, 3.0)), black(0.0)])
    assert_mean(image, np.full(3, reflected([mirrored(1.0, 1.5), mirrored(1.5, 1.0)])))


def test_a_bubble_of_higher_priority(device: cl.Device) -> None:
    image = seen(device, [slab(0.2, 2.0, glass(1, 1.5)), slab(0.8, 1.5, glass(2, 1.0)), black(0.0)])
    parts = [mirrored(1.0, 1.5)] * 4
    assert_mean(image, np.full(3, reflected(parts)))


def test_five_boundaries_of_the_same_body(device: cl.Device) -> None:
    """Walls of one body that are several shapes: only the outermost two are there."""
    image = seen(device, [*(slab(1.0 - 0.1 * i, 1.2 + 0.1 * i, "glass") for i in range(3)), black(0.0)], materials={"glass": glass(1, 1.5)})
    assert_mean(image, np.full(3, reflected([mirrored(1.0, 1.5), mirrored(1.5, 1.0)])))


def test_beers_law_of_the_body_that_is_there(device: cl.Device) -> None:
    """Overlapping bodies of index 1 before a lamp in the second: 0.8 m of the first, then 0.7 m of the second."""
    red, green = [1.0, 0.25, 0.25], [0.5, 1.0, 0.5]
    geometry = [slab(1.2, 2.0, glass(2, 1.0, transmittance=red, transmittance_distance=1.0)),
                slab(-1.0, 1.4, glass(1, 1.0, transmittance=green, transmittance_distance=1.0)), black(0.5, emission=1.0)]
    image = seen(device, geometry, spp=1)
    np.testing.assert_allclose(image.pixels, np.broadcast_to(np.array(red) ** 0.8 * np.array(green) ** 0.7, image.pixels.shape), rtol=1e-4)


def test_max_depth_does_not_count_hidden_boundaries(device: cl.Device) -> None:
    geometry = [slab(0.2, 2.0, glass(2, 1.0)), *(slab(0.4 + 0.1 * i, 1.0 + 0.1 * i, glass(1, 2.0)) for i in range(3)), black(0.0, emission=1.0)]
    image = seen(device, geometry, spp=1, integrator={"max_depth": 2})
    np.testing.assert_allclose(image.pixels, 1.0, rtol=1e-5)


@pytest.mark.parametrize("roughness", [0.0, 0.4])
def test_furnace(device: cl.Device, roughness: float) -> None:
    """Clear bodies under a white sky are invisible, whatever overlaps."""
    geometry = [{"type": "sphere", "position": [x, 0, 0], "radius": 0.4, "material": glass(priority, ior, roughness=rough)}
                for x, priority, ior, rough in ((-0.3, 1, 1.33, 0.0), (0.0, 3, 1.5, roughness), (0.3, 2, 1.31, 0.0))]
    image = seen(device, geometry, integrator={"max_depth": 200, "russian_roulette_depth": None})
    # The compensation's tables are good to 0.005 at each of a few crossings.
    assert abs(image.pixels.mean() - 1.0) < (1e-3 if roughness == 0.0 else 0.01)


def test_light_behind_hidden_boundaries(device: cl.Device) -> None:
    """A diffuse floor in clear water lit by a lamp in the same water, through a hidden boundary, is lit as without all that."""
    def room(bodies: list[Json]) -> Json:
        return {"camera": {"position": [0, 0.5, 2], "look_at": [0, 0, 0], "fov": 30}, "film": {"width": 24, "height": 24},
                "sampler": {"type": "independent", "spp": 256},
                "geometry": [{"type": "rectangle", "transform": [{"rotate": {"axis": [1, 0, 0], "angle": -90}}]}, *bodies],
                "lights": [{"type": "area", "position": [0, 1, 0], "radius": 0.3, "radiance": 3}]}

    water = [{"type": "box", "min": [-9, -9, -9], "max": [9, 1.6, 1.5], "material": glass(2, 1.0)},
             {"type": "box", "min": [-4, 0.3, -4], "max": [4, 0.5, 0.9], "material": glass(1, 1.0)}]
    plain, nested = render(device, room([])), render(device, room(water))
    difference = nested.pixels.astype(np.float64) - plain.pixels
    z = difference.mean() / np.sqrt((nested.variance + plain.variance).mean() / difference.size)
    assert abs(z) < 4.0, f"{nested.pixels.mean()} for {plain.pixels.mean()}"


def test_only_scenes_with_priorities_carry_bodies() -> None:
    one = {"scene": {"geometry": [slab(0.0, 1.0, {"type": "dielectric"})]}}
    assert not compile_scene(lumiere.load(one)).features.nested
    one["scene"]["geometry"][0]["material"]["priority"] = 1
    buffers = compile_scene(lumiere.load(one))
    assert buffers.features.nested and "bodies" in buffers.arrays and buffers.features.bsdf_features["dielectric"] == ("PRIORITY",)


def test_what_a_body_cannot_be() -> None:
    for keys, complaint in (({"transmittance": 0.5}, "transmittance_distance"), ({"ior": {"type": "checker", "a": 1, "b": 2}}, "ior")):
        with pytest.raises(SceneError, match=complaint):
            lumiere.load({"scene": {"geometry": [slab(0.0, 1.0, glass(1, 1.5) | keys)]}})
