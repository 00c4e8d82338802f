"""How long paths are and what their ends are worth: furnaces, closed and open, of which every pixel's radiance is known."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from lumiere.film.image import Image
from tests.render.scenes import Json, assert_exact, assert_mean, from_above, render

Array = np.ndarray

ALBEDO = np.array([0.9, 0.5, 0.1])
EMISSION = np.array([0.3, 1.1, 1.7])
WALL = {"material": {"type": "lambert", "albedo": list(ALBEDO)}, "emission": list(EMISSION), "emission_sides": "both"}
OUTSIDE = [{"type": shape, "transform": [{"translate": [0, -1e4, 0]}]} for shape in ("box", "sphere", "disk", "plane")]
FURNACES = {"box": [{"type": "box"} | WALL, *OUTSIDE], "sphere": [{"type": "sphere", "radius": 1.3} | WALL, *OUTSIDE]}
"""Closed rooms whose walls emit and reflect the same everywhere. What is far outside gives them the features of each other's and of the scenes in
test_direct_light.py, and so their programs."""


def series(depth: int) -> Array:
    """Radiance in a closed furnace, of up to ``depth`` reflections: e (1 + ρ + … + ρ^depth)."""
    return EMISSION * np.sum(ALBEDO ** np.arange(depth + 1)[:, None], axis=0)


def furnace(device: cl.Device, room: str, integrator: Json, spp: int = 32, film: Json | None = None) -> Image:
    return render(device, {"camera": from_above(0.3, 1.7), "film": {"width": 16, "height": 16} | (film or {}), "sampler": {"type": "independent", "spp": spp},
                           "integrator": integrator, "geometry": FURNACES[room], "lights": [{"type": "environment", "radiance": 0}]})


each_room = pytest.mark.parametrize("room", FURNACES)


@each_room
def test_depth_0_is_what_is_seen_directly(device: cl.Device, room: str) -> None:
    assert_exact(furnace(device, room, {"max_depth": 0}).pixels, EMISSION)


def test_many_samples_add_up(device: cl.Device) -> None:
    """Sixteen thousand equal samples: a plain sum in float32 would be off in the fifth digit."""
    image = furnace(device, "box", {"max_depth": 0}, spp=1 << 14, film={"width": 4, "height": 4})
    assert_exact(image.pixels, EMISSION, roundings=2)
    assert np.all(image.variance <= (1e-6 * EMISSION) ** 2)


@each_room
@pytest.mark.parametrize("depth", [1, 2, 5, 16])
def test_depth_counts_reflections(device: cl.Device, room: str, depth: int) -> None:
    assert_mean(furnace(device, room, {"max_depth": depth, "russian_roulette_depth": None}), series(depth))


@each_room
def test_direct_is_one_reflection(device: cl.Device, room: str) -> None:
    image = furnace(device, room, {"type": "direct", "max_depth": 9})
    assert_mean(image, series(1))
    assert np.array_equal(image.pixels, furnace(device, room, {"max_depth": 1}).pixels)


@each_room
@pytest.mark.parametrize("roulette", [0, 1, 5])
def test_roulette_changes_no_mean(device: cl.Device, room: str, roulette: int) -> None:
    """Paths that may end after any reflection average to the same as those that never do."""
    image = furnace(device, room, {"max_depth": 40, "russian_roulette_depth": roulette}, spp=64)
    assert_mean(image, series(40))


def test_roulette_ends_paths(device: cl.Device) -> None:
    """It is there to save rays: with albedos of 0.9 and less, most of 40 reflections."""
    rays = [furnace(device, "box", {"max_depth": 40, "russian_roulette_depth": depth}, spp=4).record["rays"]["nearest"] for depth in (None, 1)]
    assert rays[0] == 16 * 16 * 4 * 41
    assert rays[1] < rays[0] / 2


@pytest.mark.parametrize(("sampling", "room"), [("light", "sphere"), ("bsdf", "sphere"), ("bsdf", "box")])
def test_furnace_by_either_technique(device: cl.Device, sampling: str, room: str) -> None:
    """Not the box by light sampling alone: in its edges 1 / distance² has no bound, and samples no variance."""
    assert_mean(furnace(device, room, {"max_depth": 5, "light_sampling": sampling}, spp=64), series(5))


def test_clamp_bounds_what_is_indirect_and_is_recorded(device: cl.Device) -> None:
    """Direct light stays as it is; every indirect contribution is at most the bound, its hue kept; the record says that there is a bias."""
    clamped = furnace(device, "box", {"max_depth": 3, "clamp_indirect": 0.01}, film={"aovs": ["direct", "indirect", "emission"]})
    assert clamped.record["bias"] == {"clamp_indirect": 0.01}
    assert_mean(Image(pixels=clamped.pixels - clamped.aovs["indirect"], variance=clamped.variance, record=clamped.record), series(1), roundings=256)
    # Two reflections more, of two contributions each: a light's and the wall's that is met.
    assert 0.0 < clamped.aovs["indirect"].max() <= 4 * 0.01 * (1.0 + 1e-5)
    unclamped = furnace(device, "box", {"max_depth": 3, "clamp_indirect": 1e30}, film={"aovs": ["direct", "indirect", "emission"]})
    assert_mean(unclamped, series(3))


# Open furnaces: a sky of radiance 1 ----------------------------------------------------------------------------------------------------------

SKY = [{"type": "environment", "radiance": 1}]
WHITE = {
    "lambert": {"type": "lambert", "albedo": 1.0},
    "mirror": {"type": "mirror"},
    "metal": {"type": "conductor", "metal": "none"},
    "glass": {"type": "dielectric", "ior": 1.5},
    "pane": {"type": "thin_dielectric", "ior": 1.5},
}
"""Materials that lose no light: under a white sky they cannot be seen."""


def white_scene(objects: list[Json], materials: dict[str, Json] = WHITE, spp: int = 64, depth: int = 400, roulette: int | None = None) -> Json:
    """``objects`` seen from above, and far away one of each material, so that features are the same."""
    apart = [{"type": "sphere", "position": [1e5, 0, 4e3 * i], "material": name} for i, name in enumerate(materials)]
    apart.append({"type": "rectangle", "transform": [{"translate": [1e5, 0, -4e3]}], "material": "lambert"})
    return {"camera": from_above(5.0, 4.0), "film": {"width": 24, "height": 24}, "sampler": {"type": "independent", "spp": spp},
            "integrator": {"max_depth": depth, "russian_roulette_depth": roulette}, "materials": materials, "geometry": [*objects, *apart],
            "lights": SKY}


@pytest.mark.parametrize("material", WHITE)
def test_white_sphere_vanishes_in_a_white_sky(device: cl.Device, material: str) -> None:
    image = render(device, white_scene([{"type": "sphere", "radius": 1.6, "material": material}]))
    assert_mean(image, np.ones(3), roundings=1 << 10)  # some hundred reflections in the glass, each rounding the path's weight


def test_white_things_vanish_together(device: cl.Device) -> None:
    """All of them, reflecting each other: glass in front of a mirror beside metal on a Lambertian floor, behind a pane."""
    objects = [{"type": "sphere", "position": [1.0 * x, 0.2 * x * z, 1.0 * z], "radius": 0.55, "material": list(WHITE)[(3 * x + z) % 4]}
               for x in (-1, 0, 1) for z in (-1, 0, 1)]
    flat = [{"rotate": {"axis": [1, 0, 0], "angle": -90}}]
    objects.append({"type": "rectangle", "material": "lambert", "transform": [{"scale": [3, 3, 1]}, *flat, {"translate": [0, -1, 0]}]})
    objects.append({"type": "rectangle", "material": "pane", "transform": [{"scale": [1, 3, 1]}, *flat, {"translate": [0.5, 2, 0]}]})
    image = render(device, white_scene(objects, roulette=3))
    assert_mean(image, np.ones(3), roundings=1 << 10)


def test_mirrors_and_metals_reflect_by_their_colour(device: cl.Device) -> None:
    """Seen at normal incidence, a mirror gives its reflectance and a metal ((η − 1)² + k²) / ((η + 1)² + k²); a pane loses what it tints."""
    eta, k = np.array([0.2, 1.1, 2.0]), np.array([3.0, 2.5, 0.5])
    materials = {"lambert": {"type": "lambert", "albedo": 0.3}, "mirror": {"type": "mirror", "reflectance": [0.9, 0.5, 0.1]},
                 "metal": {"type": "conductor", "eta": list(eta), "k": list(k)}, "glass": {"type": "dielectric"},
                 "pane": {"type": "thin_dielectric", "ior": 1.5, "transmittance": [0.8, 0.5, 0.2]}}
    flat = [{"scale": [1, 2, 1]}, {"rotate": {"axis": [1, 0, 0], "angle": -90}}]
    objects = [{"type": "rectangle", "material": "mirror", "transform": [*flat, {"translate": [-1, 0, 0]}]},
               {"type": "rectangle", "material": "metal", "transform": [*flat, {"translate": [1, 0, 0]}]}]
    image = render(device, white_scene(objects, materials, spp=2))
    assert_exact(image.pixels[:, :11], (0.9, 0.5, 0.1))
    assert_exact(image.pixels[:, 13:], ((eta - 1.0) ** 2 + k**2) / ((eta + 1.0) ** 2 + k**2))
    # A pane: R = 2 r / (1 + r) of r = 0.04 is reflected, and of the rest what the tint leaves comes through (one pass through the pane).
    image = render(device, white_scene([objects[0] | {"material": "pane"}], materials, spp=2048))
    reflected = 2.0 * 0.04 / 1.04
    left = np.zeros((24, 24), bool)
    left[:, :11] = True
    assert_mean(image, reflected + (1.0 - reflected) * np.array([0.8, 0.5, 0.2]), where=left)


@pytest.mark.parametrize(("angle", "expected"), [(-90, 0.04 + 0.96 / 1.5**2), (90, 0.04 + 0.96 * 1.5**2)], ids=["into glass", "out of glass"])
def test_radiance_is_scaled_where_it_crosses_an_interface(device: cl.Device, angle: float, expected: float) -> None:
    """One surface of glass between the viewer and a sky in the glass, or the other way round: L / n² is what is kept (Veach 1997, §5.2)."""
    surface = {"type": "rectangle", "material": "glass", "transform": [{"scale": [3, 3, 1]}, {"rotate": {"axis": [1, 0, 0], "angle": angle}}]}
    assert_mean(render(device, white_scene([surface], roulette=1)), np.full(3, expected))


# Ambient occlusion ---------------------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("planes", "expected"), [(1, 1.0), (2, 0.5), (3, 0.25)])
def test_ambient_occlusion(device: cl.Device, planes: int, expected: float) -> None:
    """A floor is open to all of the sky, to half of it beside a wall that never ends, to a quarter in a corner: whatever its material and light."""
    floor = {"type": "plane", "material": {"type": "lambert", "albedo": 0.1}, "emission": 3}
    walls = [{"type": "plane", "position": [-2, 0, 0], "normal": [1, 0, 0]}, {"type": "plane", "position": [0, 0, -2], "normal": [0, 0, 1]}]
    image = render(device, {"camera": from_above(3.0, 2.0), "film": {"width": 16, "height": 16}, "sampler": {"type": "independent", "spp": 64},
                            "integrator": {"type": "ambient_occlusion"}, "geometry": [floor, *walls[:planes - 1]],
                            "lights": [{"type": "point", "position": [0, 1, 0], "intensity": 9}]})
    assert_mean(image, np.full(3, expected))
