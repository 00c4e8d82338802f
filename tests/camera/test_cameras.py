"""Rays of each camera, as the renderer starts them, against closed forms of the pixel's place."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pyopencl as cl
import pytest

from lumiere.compile.scene import compile_scene
from lumiere.scene.load import load
from lumiere.wavefront.batch import Batch, pixel_order
from lumiere.wavefront.lanes import CAMERAS
from lumiere.wavefront.policy import is_gpu
from tests.render.probe import Probe
from tests.render.scenes import POINT_FILTER, Json
from tests.statistics import chi_square

Array = np.ndarray

WIDTH, HEIGHT = 12, 8
EYE, TARGET, UP = np.array([1.0, 2.0, 3.0]), np.array([0.0, 1.5, -1.0]), np.array([0.1, 1.0, 0.0])

ALONE = "start_path(&scene, &path, &samples, item, item);"
IN_LANES = "start_paths(&scene, &path, &samples, item, 1u, &item);"
START = """
    vstore3(path_get_origin(&path, item), 3u * item, out_floats);
    vstore3(path_get_direction(&path, item), 3u * item + 1u, out_floats);
    vstore3(path_get_throughput(&path, item), 3u * item + 2u, out_floats);
"""


def axes() -> Array:
    """(3, 3) rows: right, up, and backwards (against the view)."""
    back = (EYE - TARGET) / np.linalg.norm(EYE - TARGET)
    right = np.cross(UP, back) / np.linalg.norm(np.cross(UP, back))
    return np.stack([right, np.cross(back, right), back])


def starting(device: cl.Device, scene: Json) -> Probe:
    """Starts a path an item, in the form that the device gets for the scene's camera."""
    lanes = not is_gpu(device) and scene["scene"]["camera"].get("type", "perspective") in CAMERAS
    return Probe(device, scene, "generate", (IN_LANES if lanes else ALONE) + START)


def start(device: cl.Device, camera: Json, spp: int = 1, crop: list[int] | None = None, filter: Json = POINT_FILTER) -> tuple[Array, Array, Array]:
    """Origins, directions and weights, each (height, width, spp, 3), of the rays of a picture or its crop, in the camera's own axes."""
    film = {"width": WIDTH, "height": HEIGHT, "filter": filter} | ({"crop": crop} if crop else {})
    placed = {"position": list(EYE), "look_at": list(TARGET), "up": list(UP)} | camera
    scene = {"camera": placed, "film": film, "sampler": {"type": "independent", "spp": spp}, "geometry": [{"type": "plane"}]}
    width, height = (crop[2] - crop[0], crop[3] - crop[1]) if crop else (WIDTH, HEIGHT)
    count = width * height * spp
    out, _ = starting(device, {"scene": scene})(count, out_floats=9, batch=Batch(0, width * height, spp, 0))
    rays = np.zeros((width * height, spp, 3, 3))
    rays[pixel_order(width, height)] = out.astype(np.float64).reshape(width * height, spp, 3, 3)
    rays = rays.reshape(height, width, spp, 3, 3)
    return (rays[..., 0, :] - EYE) @ axes().T, rays[..., 1, :] @ axes().T, rays[..., 2, :]


def film() -> tuple[Array, Array]:
    """x to the right and y up of the pixels' centres, each (HEIGHT, WIDTH), from −1 to 1 over the picture."""
    x, y = np.meshgrid(2.0 * (np.arange(WIDTH) + 0.5) / WIDTH - 1.0, 1.0 - 2.0 * (np.arange(HEIGHT) + 0.5) / HEIGHT)
    return x, y


def normalized(v: Array) -> Array:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def halves(fov: float, axis: str) -> tuple[float, float]:
    """Half width and height: ``fov`` along the one that ``axis`` names."""
    along_x = axis in ("x", "larger")
    return (1.0, HEIGHT / WIDTH) if along_x else (WIDTH / HEIGHT, 1.0)


def perspective(fov: float, axis: str) -> Callable[[], Array]:
    x, y = film()
    hx, hy = halves(fov, axis)
    t = np.tan(np.radians(fov) / 2.0)
    return normalized(np.stack([x * hx * t, y * hy * t, -np.ones_like(x)], axis=-1))


def fisheye(fov: float, axis: str) -> Array:
    x, y = film()
    hx, hy = halves(fov, axis)
    angle = np.stack([x * hx, y * hy], axis=-1) * np.radians(fov) / 2.0
    theta = np.linalg.norm(angle, axis=-1, keepdims=True)
    return np.concatenate([np.sin(theta) * angle / theta, -np.cos(theta)], axis=-1)


def panorama() -> Array:
    x, y = film()
    phi, theta = np.pi * x, np.pi * (1.0 - y) / 2.0
    return np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)], axis=-1)


SLACK = 64.0 * 2.0**-24 * np.linalg.norm(EYE)
"""Roundings of coordinates of the size of the camera's."""


@pytest.mark.parametrize("axis", ["x", "y", "smaller", "larger"])
@pytest.mark.parametrize("fov", [40.0, 120.0])
def test_perspective(device: cl.Device, fov: float, axis: str) -> None:
    origin, direction, weight = (a[:, :, 0] for a in start(device, {"type": "perspective", "fov": fov, "fov_axis": axis}))
    assert np.abs(origin).max() < SLACK
    assert np.abs(direction - perspective(fov, axis)).max() < SLACK
    assert np.all(weight == 1.0)


@pytest.mark.parametrize("axis", ["x", "y"])
@pytest.mark.parametrize("fov", [150.0, 360.0])
def test_fisheye(device: cl.Device, fov: float, axis: str) -> None:
    """The angle to the axis is the distance from the centre; beyond 180° there is no ray."""
    origin, direction, weight = (a[:, :, 0] for a in start(device, {"type": "fisheye", "fov": fov, "fov_axis": axis}))
    x, y = film()
    hx, hy = halves(fov, axis)
    sees = np.hypot(x * hx, y * hy) * fov / 2.0 <= 180.0
    assert sees.any() and sees.all() == (fov < 360.0)
    assert np.array_equal(weight[..., 0] == 1.0, sees)
    assert np.abs(origin[sees]).max() < SLACK
    assert np.abs(direction - fisheye(fov, axis))[sees].max() < SLACK


def test_panorama(device: cl.Device) -> None:
    """Lat-long: the centre column ahead, columns to the right, the top up."""
    origin, direction, _ = (a[:, :, 0] for a in start(device, {"type": "panorama"}))
    assert np.abs(origin).max() < SLACK
    assert np.abs(direction - panorama()).max() < SLACK


def test_orthographic(device: cl.Device) -> None:
    """Parallel rays from a window of the given height."""
    origin, direction, _ = (a[:, :, 0] for a in start(device, {"type": "orthographic", "height": 3.0}))
    x, y = film()
    assert np.abs(origin - np.stack([x * 1.5 * WIDTH / HEIGHT, y * 1.5, np.zeros_like(x)], axis=-1)).max() < SLACK
    assert np.abs(direction - (0.0, 0.0, -1.0)).max() < SLACK


@pytest.mark.parametrize("blades", [0, 3, 6])
def test_thin_lens(device: cl.Device, blades: int) -> None:
    """A pixel's rays start all over the aperture, evenly, and meet where a pinhole's ray crosses the plane in focus."""
    radius, focus, spp = 0.3, 4.0, 256
    camera = {"type": "thin_lens", "fov": 50, "aperture_radius": radius, "focus_distance": focus, "blades": blades}
    origin, direction, _ = start(device, camera, spp)
    assert np.abs(origin[..., 2]).max() < SLACK
    t = -(focus + origin[..., 2]) / direction[..., 2]
    met = origin + t[..., None] * direction
    pinhole = perspective(50.0, "y")
    expected = pinhole * (focus / -pinhole[..., 2:])
    assert np.abs(met - expected[:, :, None]).max() < 4.0 * SLACK

    at = origin[..., :2].reshape(-1, 2) / radius
    if blades == 0:
        r, phi = np.hypot(*at.T), np.arctan2(at[:, 1], at[:, 0]) / (2.0 * np.pi) % 1.0
        area, turn = r**2, phi
    else:
        # In the triangle of the centre and one side: the share of the area nearer to the centre, and the place along the side.
        phi = np.arctan2(at[:, 1], at[:, 0]) % (2.0 * np.pi)
        blade = np.floor(phi * blades / (2.0 * np.pi))
        middle = (blade + 0.5) * 2.0 * np.pi / blades
        height = (at[:, 0] * np.cos(middle) + at[:, 1] * np.sin(middle)) / np.cos(np.pi / blades)
        side = (at[:, 1] * np.cos(middle) - at[:, 0] * np.sin(middle)) / (height * np.sin(np.pi / blades))
        area, turn = height**2, (blade + 0.5 * (side + 1.0)) / blades
    assert area.max() <= 1.0 + 64.0 * SLACK
    cells = np.minimum(area * 8, 7).astype(int) * 24 + np.minimum(turn * 24, 23).astype(int)
    counts = np.bincount(cells, minlength=192).astype(float)
    assert chi_square(counts, np.full(192, counts.sum() / 192)) > 1e-4


def test_transform_places_the_camera(device: cl.Device) -> None:
    """A transform in place of position and look_at: the camera looks down its own −Z."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes().T, EYE
    camera = {"type": "perspective", "fov": 40, "fov_axis": "y", "transform": [{"matrix": list(matrix.ravel())}]}
    film = {"width": WIDTH, "height": HEIGHT, "filter": POINT_FILTER}
    scene = {"camera": camera, "film": film, "sampler": {"type": "independent", "spp": 1}, "geometry": [{"type": "plane"}]}
    out, _ = starting(device, {"scene": scene})(WIDTH * HEIGHT, out_floats=9)
    rays = np.zeros((WIDTH * HEIGHT, 9))
    rays[pixel_order(WIDTH, HEIGHT)] = out
    assert np.abs(rays[:, :3] - EYE).max() < SLACK
    assert np.abs(rays[:, 3:6].reshape(HEIGHT, WIDTH, 3) @ axes().T - perspective(40.0, "y")).max() < SLACK


def test_crop_sees_its_part(device: cl.Device) -> None:
    whole = start(device, {"type": "perspective"}, spp=4, filter={"type": "box"})
    part = start(device, {"type": "perspective"}, spp=4, crop=[3, 2, 9, 7], filter={"type": "box"})
    for a, b in zip(whole, part, strict=True):
        assert np.array_equal(a[2:7, 3:9], b)


def test_samples_cover_the_pixel(device: cl.Device) -> None:
    """The box filter of half a pixel: evenly over the pixel, and not beyond."""
    _, direction, _ = start(device, {"type": "perspective", "fov": 40, "fov_axis": "y"}, spp=256, filter={"type": "box"})
    t = np.tan(np.radians(20.0))
    at = -direction[..., :2] / direction[..., 2:] / t * (HEIGHT / WIDTH, 1.0)
    x, y = film()
    offset = (at - np.stack([x, y], axis=-1)[:, :, None]) * (WIDTH, HEIGHT) / 2.0
    assert np.abs(offset).max() <= 0.5 + WIDTH * SLACK
    cells = np.clip(np.floor((offset + 0.5) * 8), 0, 7).astype(int).reshape(-1, 2) @ (8, 1)
    counts = np.bincount(cells, minlength=64).astype(float)
    assert chi_square(counts, np.full(64, counts.sum() / 64)) > 1e-4


def test_missing_camera_frames_everything() -> None:
    """Where the file has no camera, a pinhole sees all that is bounded, and no more than its surrounding sphere."""
    low, high = np.array([20.0, -12.0, -3.0]), np.array([45.0, 9.0, 8.0])
    for width, height in ((33, 21), (21, 33), (16, 16)):
        buffers = compile_scene(load({"scene": {"film": {"width": width, "height": height}, "geometry": [
            {"type": "sphere", "position": [40, -7, 3], "radius": 5}, {"type": "box", "min": [20, -5, -3], "max": [22, 9, 2]}, {"type": "plane"}]}}))
        assert buffers.features.camera == "perspective"
        record = buffers.arrays["camera"][1][0]
        matrix, half = record["to_world"].reshape(3, 4).astype(np.float64), record["half_extent"].astype(np.float64)
        corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), -1).reshape(-1, 3) - buffers.origin
        local = (corners - matrix[:, 3]) @ matrix[:, :3]
        assert np.all(local[:, 2] < 0.0)
        at = local[:, :2] / -local[:, 2:] / half
        assert np.abs(at).max() <= 1.0
        # The sphere around the box touches the picture's shorter sides.
        assert np.abs(at[:, np.argmin(half)]).max() > 0.5
