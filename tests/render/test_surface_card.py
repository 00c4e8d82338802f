"""Textures, maps, sides, visibility and opacity on a test card under one parallel light: every pixel against its closed form."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from lumiere.film.image import Image
from tests.render.card import UP, Card, Cell, uv, write_exr, write_png
from tests.render.scenes import Json

Array = np.ndarray

LIGHT = np.array([0.3, -0.8, 0.2]) / np.linalg.norm([0.3, -0.8, 0.2])
"""Direction of travel. Its irradiance makes a flat surface's radiance its albedo."""

GRAY = np.array([0.6, 0.5, 0.4])
TEXELS = np.random.default_rng(1).random((3, 4, 3))
BYTES = np.random.default_rng(2).integers(0, 256, (4, 4, 4), dtype=np.uint8)
HOLES = np.array([[[1.0], [0.0]], [[0.0], [1.0]]])
CORNERS = np.array([[0.9, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.7], [0.6, 0.6, 0.6]])
RAISED = 0.45
"""Height of sheets over their floor: no pixel's centre lies on a shadow's edge."""


def srgb_decode(x: Array) -> Array:
    """IEC 61966-2-1:1999."""
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def flat(**material: object) -> Json:
    return {"type": "rectangle", "transform": UP, "material": {"type": "lambert"} | material}


def textured(**texture: object) -> Json:
    return flat(albedo=texture)


def raised(shape: Json, height: float = RAISED) -> Json:
    return shape | {"transform": [*shape["transform"], {"translate": [0, height, 0]}]}


def wrapped(i: Array, size: int, wrap: str) -> Array:
    if wrap == "clamp":
        return np.clip(i, 0, size - 1)
    i = i % size if wrap == "repeat" else i % (2 * size)
    return np.where(i < size, i, 2 * size - 1 - i)


def picture(at: Array, texels: Array, *, wrap: str = "repeat", filter: str = "bilinear", scale: float = 1.0, offset: tuple[float, float] = (0.0, 0.0),
            ) -> Array:
    """A picture looked up at uv · scale + offset: row 0 of ``texels`` is at the top, uv (0, 0) at the bottom left, texel centres at (i + ½) / size."""
    texels = texels[::-1]
    height, width = texels.shape[:2]
    x, y = ((uv(at) * scale + offset) * (width, height)).T
    take = lambda i, j: texels[wrapped(j, height, wrap), wrapped(i, width, wrap)]  # noqa: E731
    if filter == "nearest":
        return take(np.floor(x).astype(int), np.floor(y).astype(int))
    x, y = x - 0.5, y - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - i)[:, None], (y - j)[:, None]
    return (1 - fy) * ((1 - fx) * take(i, j) + fx * take(i + 1, j)) + fy * ((1 - fx) * take(i, j + 1) + fx * take(i + 1, j + 1))


def checker(at: Array, a: Array, b: Array, scale: tuple[float, float]) -> Array:
    even = np.floor(uv(at) * scale).sum(axis=1) % 2 == 0
    return np.where(even[:, None], a, b)


def tilted(albedo: Array, normal: Array) -> Array:
    """Radiance of a surface of this normal."""
    normal = np.asarray(normal, float) / np.linalg.norm(normal)
    return albedo * max(0.0, -LIGHT @ normal) / -LIGHT[1]


def over(at: Array, height: float) -> Array:
    """Where the light that reaches points of the floor passes a height."""
    return at - LIGHT * (height / -LIGHT[1])


def inside(at: Array, half: float | tuple[float, float] = 0.5) -> Array:
    return np.all(np.abs(at[:, [0, 2]]) < half, axis=1)


WIDE = (0.55, 0.65)
"""Half the size of sheets whose diagonal passes no pixel's centre: there a ray meets both triangles, by chance never."""


def veil(height: float) -> Json:
    """A black sheet that stops every second ray."""
    place = [{"scale": [2.0 * WIDE[0], 2.0 * WIDE[1], 1.0]}, *UP, {"translate": [0, height, 0]}]
    return {"type": "rectangle", "transform": place, "material": {"type": "lambert", "albedo": 0, "opacity": 0.5}}


def normal_texture(x: float, y: float, z: float) -> Json:
    n = np.array([x, y, z]) / np.linalg.norm([x, y, z])
    return {"type": "constant", "value": list(0.5 + 0.5 * n)}


def square_mesh(**keys: object) -> Json:
    """The rectangle as a mesh in the cell's own space."""
    vertices = [[-0.5, 0, 0.5], [0.5, 0, 0.5], [0.5, 0, -0.5], [-0.5, 0, -0.5]]
    return {"type": "mesh", "vertices": vertices, "faces": [[0, 1, 2], [0, 2, 3]], "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]],
            "material": {"type": "lambert", "albedo": list(GRAY)}} | keys


def write_ply(path: Path) -> None:
    """The rectangle with an 8-bit colour at each corner."""
    corners = [[-0.5, 0, 0.5], [0.5, 0, 0.5], [0.5, 0, -0.5], [-0.5, 0, -0.5]]
    lines = ["ply", "format ascii 1.0", "element vertex 4", *[f"property float {name}" for name in "xyz"],
             *[f"property uchar {name}" for name in ("red", "green", "blue")], "element face 2", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(str, [*p, *np.round(255 * c).astype(int)])) for p, c in zip(corners, CORNERS, strict=True)]
    path.write_text("\n".join([*lines, "3 0 1 2", "3 0 2 3", ""]))


def write_files(folder: Path) -> None:
    """What the cells name."""
    write_exr(folder / "texels.exr", TEXELS)
    write_png(folder / "bytes.png", BYTES)
    write_exr(folder / "ramp.exr", np.array([[[0.1] * 3, [0.3] * 3]]))
    write_exr(folder / "holes.exr", np.repeat(HOLES, 3, axis=2))
    write_ply(folder / "square.ply")


def interpolated(at: Array) -> Array:
    """Of the corners' colours over the two triangles, 8-bit and sRGB-encoded as stored."""
    a, b, c, d = srgb_decode(np.round(255 * CORNERS) / 255)
    u, v = uv(at).T[..., None]
    # Below the diagonal from corner 0 to corner 2 the triangle is 0, 1, 2; above it 0, 2, 3.
    return np.where(v < u, (1 - u) * a + (u - v) * b + v * c, (1 - v) * a + u * c + (v - u) * d)


def covered(at: Array, above: Array, opaque: Array, lit: Array) -> Array:
    """A raised sheet of radiance ``above`` where it is opaque, else the grey floor, where it is lit."""
    return np.where(opaque[:, None], above, np.where(lit[:, None], GRAY, 0.0))


def under_checker(at: Array, above: Array) -> Array:
    holes = lambda p: checker(p, np.ones(1), np.zeros(1), (2.0, 2.0))[:, 0] == 0.0  # noqa: E731
    through = over(at, RAISED)
    return covered(at, above, ~holes(at), holes(through) | ~inside(through))


def under_picture(at: Array, above: Array) -> Array:
    holes = lambda p: picture(p, HOLES, filter="nearest")[:, 0] == 0.0  # noqa: E731
    through = over(at, RAISED)
    return covered(at, above, ~holes(at), holes(through) | ~inside(through))


def all_of(value: Array) -> Callable[[Array], Array]:
    return lambda at: np.broadcast_to(value, (len(at), 3))


def in_sphere(at: Array, w: Array, center: Array, radius: float) -> Array:
    """Does the line from ``at`` along the unit ``w`` cross a sphere?"""
    towards = center - at
    return np.linalg.norm(towards - np.outer(towards @ w, w), axis=1) < radius


def cells(folder: Path) -> dict[str, Cell]:
    """The card: exact cells, and cells of chance whose mean is known."""
    gray, white = list(GRAY), np.array([0.4, 0.2, 0.9])
    lambert = {"type": "lambert", "albedo": gray}
    image = {"type": "image", "file": str(folder / "texels.exr")}
    image8 = {"type": "image", "file": str(folder / "bytes.png")}
    decoded = srgb_decode(BYTES[..., :3] / 255.0)
    floor = flat(albedo=gray)
    sheet = {"type": "rectangle", "transform": [{"scale": 0.5}, *UP, {"translate": [0, RAISED, 0]}],
             "material": {"type": "lambert", "albedo": list(white)}}
    below = [{"scale": 0.5}, {"rotate": {"axis": [1, 0, 0], "angle": 90}}]
    tilt = normal_texture(0.3, -0.2, 1)

    def wrap_cell(wrap: str, filter: str) -> Cell:
        keys = {"wrap": wrap, "filter": filter, "scale": 2.6, "offset": [-0.7, -1.1]}
        # Bilinear weights are differences of coordinates of up to 4 · 2.6 texels.
        return Cell([textured(**image, **keys)], lambda at: picture(at, TEXELS, **keys), roundings=64 if filter == "nearest" else 1024)

    def half_of_ball(at: Array, height: float = 1.0) -> Array:
        # A ball of this height, stretched until it is a sphere.
        stretch = np.array([1.0, 1.0 / height, 1.0])
        center, w = np.array([0.0, RAISED, 0.0]) * stretch, -LIGHT * stretch
        crossed = sum(in_sphere(at, d, center, 0.4).astype(float) for d in (np.array([0.0, 1.0, 0.0]), w / np.linalg.norm(w)))
        return GRAY * 0.25 ** crossed[:, None]

    return {
        "number": Cell([flat(albedo=0.3)], all_of(0.3)),
        "rgb": Cell([floor], all_of(GRAY)),
        # The scene's own decoding is in float64: one rounding.
        "hex colour": Cell([flat(albedo="#804020")], all_of(srgb_decode(np.array([128, 64, 32]) / 255.0))),
        "constant": Cell([textured(type="constant", value=gray)], all_of(GRAY)),
        "checker": Cell([textured(type="checker", a=gray, b=0.1, scale=4)], lambda at: checker(at, GRAY, np.full(3, 0.1), (4.0, 4.0))),
        "checker, 2 × 3": Cell([textured(type="checker", a=gray, b=0.1, scale=[2, 3])], lambda at: checker(at, GRAY, np.full(3, 0.1), (2.0, 3.0))),
        "image": Cell([textured(**image)], lambda at: picture(at, TEXELS), roundings=256),
        "image, nearest": Cell([textured(**image, filter="nearest")], lambda at: picture(at, TEXELS, filter="nearest")),
        **{f"{wrap}, {filter}": wrap_cell(wrap, filter) for wrap in ("repeat", "clamp", "mirror") for filter in ("bilinear", "nearest")},
        # The device's power function is within 16 ulp by the OpenCL specification.
        "8 bits are sRGB": Cell([textured(**image8, filter="nearest")], lambda at: picture(at, decoded, filter="nearest"), roundings=128),
        "sRGB, bilinear": Cell([textured(**image8)], lambda at: picture(at, decoded), roundings=1024),
        "8 bits said to be linear": Cell([textured(**image8, filter="nearest", encoding="linear")],
                                         lambda at: picture(at, BYTES[..., :3] / 255.0, filter="nearest")),
        "alpha": Cell([textured(**image8, filter="nearest", channel="a", factor=[1, 0.5, 0.2])],
                      lambda at: picture(at, BYTES[..., 3:] / 255.0 * (1, 0.5, 0.2), filter="nearest")),
        "vertex colours": Cell([{"type": "mesh", "file": str(folder / "square.ply"), "material": {"type": "lambert", "albedo": {"type": "vertex_color"}}}],
                               interpolated, roundings=256, terms=float(srgb_decode(CORNERS).max())),
        "vertex colours, none": Cell([flat(albedo={"type": "vertex_color"})], all_of(1.0)),
        "normal map, flat": Cell([flat(albedo=gray, normal_map={"type": "constant", "value": [0.5, 0.5, 1]})], all_of(GRAY)),
        "normal map": Cell([flat(albedo=gray, normal_map=tilt)], all_of(tilted(GRAY, [0.3, 1, 0.2]))),
        "normal map, mirrored uv": Cell([square_mesh(uvs=[[1, 0], [0, 0], [0, 1], [1, 1]], material=lambert | {"normal_map": tilt})],
                                        all_of(tilted(GRAY, [-0.3, 1, 0.2]))),
        "vertex normals": Cell([square_mesh(normals=[[0.3, 1, 0.2]] * 4, smooth=True)], all_of(tilted(GRAY, [0.3, 1, 0.2]))),
        "vertex normals, not smooth": Cell([square_mesh(normals=[[0.3, 1, 0.2]] * 4, smooth=False)], all_of(GRAY)),
        "bump map, constant": Cell([flat(albedo=gray, bump_map={"type": "constant", "value": 0.7}, bump_scale=3)], all_of(GRAY)),
        # The slope is a difference over 5e-4 of uv, by which the roundings of heights and of uv are divided.
        "bump map, ramp": Cell([flat(albedo=gray, bump_map={"type": "image", "file": str(folder / "ramp.exr"), "wrap": "clamp"}, bump_scale=0.5)],
                               lambda at: np.where((np.abs(uv(at)[:, :1] - 0.5) < 0.25), tilted(GRAY, [-0.2, 1, 0]), GRAY), roundings=int(8 / 5e-4)),
        "from behind": Cell([{"type": "rectangle", "transform": below, "material": lambert}], all_of(GRAY)),
        "from behind, one-sided": Cell([{"type": "rectangle", "transform": below, "material": lambert | {"two_sided": False}}], all_of(0.0)),
        "one-sided": Cell([flat(albedo=gray, two_sided=False)], all_of(GRAY)),
        "shadow": Cell([floor, sheet], lambda at: covered(at, white, inside(at, 0.25), ~inside(over(at, RAISED), 0.25))),
        "invisible to the camera": Cell([floor, sheet | {"visible": {"camera": False}}],
                                        lambda at: covered(at, white, np.zeros(len(at), bool), ~inside(over(at, RAISED), 0.25))),
        "without a shadow": Cell([floor, sheet | {"visible": {"shadow": False}}],
                                 lambda at: covered(at, white, inside(at, 0.25), np.ones(len(at), bool))),
        "opacity of 0": Cell([floor, raised(flat(albedo=list(white), opacity=0))], all_of(GRAY)),
        "opacity, checker": Cell([floor, raised(flat(albedo=list(white), opacity={"type": "checker", "a": 1, "b": 0, "scale": 2}))],
                                 lambda at: under_checker(at, white)),
        "opacity, picture": Cell([floor, raised(flat(albedo=list(white), opacity={"type": "image", "file": str(folder / "holes.exr"), "filter": "nearest"}))],
                                 lambda at: under_picture(at, white)),
        "opacity of ½": Cell([floor, veil(RAISED)], lambda at: GRAY * 0.5 ** (1.0 + inside(over(at, RAISED), WIDE))[:, None], chance=True),
        "opacity of ½, twice": Cell([floor, veil(RAISED), veil(RAISED / 2)], lambda at: GRAY * 0.5 ** (
            2.0 + inside(over(at, RAISED), WIDE) + inside(over(at, RAISED / 2), WIDE))[:, None], chance=True),
        "opacity of ½, sphere": Cell([floor, {"type": "sphere", "position": [0, RAISED, 0], "radius": 0.4,
                                              "material": {"type": "lambert", "albedo": 0, "opacity": 0.5}}], half_of_ball, chance=True),
        "opacity of ½, ellipsoid": Cell([floor, {"type": "sphere", "radius": 0.4, "material": {"type": "lambert", "albedo": 0, "opacity": 0.5},
                                                 "transform": [{"scale": [1, 0.5, 1]}, {"translate": [0, RAISED, 0]}]}],
                                        lambda at: half_of_ball(at, 0.5), chance=True),
    }


CELLS = cells(Path())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("card")
    write_files(path)
    return path


@cache
def rendered(device: cl.Device, folder: Path) -> tuple[Card, Image]:
    card = Card(cells(folder), columns=7)
    light = {"type": "directional", "direction": list(LIGHT), "irradiance": np.pi / -LIGHT[1]}
    return card, card.render(device, {"integrator": {"max_depth": 1}, "lights": [light]}, spp=512)


@pytest.mark.parametrize("name", CELLS)
def test_cell(device: cl.Device, folder: Path, name: str) -> None:
    card, image = rendered(device, folder)
    card.check(image, name)
