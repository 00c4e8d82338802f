"""Points on surfaces: within the error that is claimed for them, and rays that leave them do not meet them again."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import pyopencl as cl
import pytest

from tests.render.probe import Probe

Array = np.ndarray

RAYS = 100_000
NONE = 0xFFFFFFFF
EPSILON = 2.0**-24
"""Largest relative error of one rounding."""

BODY = """
    ray_t ray;
    ray.o = vload3(3u * item, in_floats);
    ray.d = vload3(3u * item + 1u, in_floats);
    ray.t_max = INFINITY;
    hit_t hit;
    global float *out = out_floats + 13u * item;
    out_uints[2u * item] = out_uints[2u * item + 1u] = 0xffffffffu;
    if (!trace_nearest(&scene, &ray, &hit))
        return;
    out_uints[2u * item] = hit.primitive;
    surface_t surface = surface_at(&scene, &ray, &hit);
    float3 w = vload3(3u * item + 2u, in_floats);
    vstore3(surface.p, 0, out);
    vstore3(surface.error, 1, out);
    vstore3(surface.ng, 2, out);
    ray.o = offset_origin(surface.p, surface.error, surface.ng, w);
    ray.d = w;
    vstore3(ray.o, 3, out);
    if (!trace_nearest(&scene, &ray, &hit))
        return;
    out_uints[2u * item + 1u] = hit.primitive;
    out[12] = hit.t;
"""


@dataclass
class Leaving:
    """Rays that met something, and rays that left from there, in float64: what each met (``first``, ``second``: a primitive or NONE), the point
    ``p`` with its ``error`` and normal ``ng``, the second ray's ``origin`` and direction ``w``, and the ``t`` at which it met something."""

    first: Array
    second: Array
    p: Array
    error: Array
    ng: Array
    origin: Array
    w: Array
    t: Array


def unit(generator: np.random.Generator, count: int) -> Array:
    v = generator.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def leave(probe: Probe, origins: Array, targets: Array) -> Leaving:
    """Rays from ``origins`` through ``targets``; from what they meet, one in any direction, a third of those nearly along the surface."""
    count = len(origins)
    generator = np.random.default_rng(1)
    w = unit(generator, count)
    directions = targets - origins
    rays = np.stack([origins, directions / np.linalg.norm(directions, axis=1, keepdims=True), w], axis=1).astype(np.float32)
    out, _ = probe(count, floats=rays, out_floats=13, out_uints=2)
    normal = out[:, 6:9].astype(np.float64)
    grazing = w - np.sum(w * normal, axis=1, keepdims=True) * normal
    grazing /= np.linalg.norm(grazing, axis=1, keepdims=True)
    grazing += normal * (10.0 ** generator.uniform(-7.0, -1.0, count) * generator.choice([-1.0, 1.0], count))[:, None]
    rays[::3, 2] = grazing[::3]
    out, met = probe(count, floats=rays, out_floats=13, out_uints=2)
    found = met[:, 0] != NONE
    assert found.mean() > 0.95, "the test's own rays miss"
    out = out.astype(np.float64)
    result = Leaving(met[:, 0], met[:, 1], out[:, 0:3], out[:, 3:6], out[:, 6:9], out[:, 9:12], rays[:, 2].astype(np.float64), out[:, 12])
    return Leaving(*(getattr(result, f.name)[found] for f in fields(result)))


def check(rays: Leaving, height: Array, origin_height: Array, normal: Array, size: Array) -> None:
    """``height`` and ``origin_height`` (n,) are those of ``p`` and ``origin`` over the true surface along its unit ``normal`` (n, 3), in float64.

    The true surface must pass through the box of the point's error, which is some roundings of coordinates of the order of ``size`` (n,): not
    less, and not far more. The origin must lie on the side to which the ray goes.
    """
    assert np.all(np.abs(height) <= np.sum(np.abs(normal) * rays.error, axis=1))
    assert np.all(rays.error.max(axis=1) <= 16.0 * EPSILON * size)
    slope = np.sum(rays.w * rays.ng, axis=1)
    told = np.abs(slope) > 4.0 * EPSILON  # else rounding says which side the ray goes to
    outwards = slope * np.sum(normal * rays.ng, axis=1) > 0.0
    assert np.all(np.where(outwards, origin_height, -origin_height)[told] > 0.0)


@pytest.mark.parametrize("distance", [0.0, 1.0, 1e3])
@pytest.mark.parametrize("radius", [1e-3, 1.0, 1e3])
def test_spheres(device: cl.Device, radius: float, distance: float) -> None:
    generator = np.random.default_rng(1)
    center = unit(generator, 1)[0] * distance
    probe = Probe(device, {"scene": {"geometry": [{"type": "sphere", "position": list(center), "radius": radius}]}}, "shade", BODY, alone=True)
    record = probe.buffers.arrays["spheres"][1][0]
    c, r = record["center"].astype(np.float64), float(record["radius"])
    away = 10.0 ** generator.uniform(0.01, 3.0, (RAYS, 1))
    rays = leave(probe, c + r * unit(generator, RAYS) * away, c + r * unit(generator, RAYS) * 0.97 * generator.random((RAYS, 1)))

    from_center, origin = rays.p - c, rays.origin - c
    length = np.linalg.norm(from_center, axis=1)
    check(rays, length - r, np.linalg.norm(origin, axis=1) - r, from_center / length[:, None], np.abs(rays.p).max(axis=1) + r)
    slope = np.sum(rays.w * rays.ng, axis=1)
    assert np.all(rays.second[slope > 4.0 * EPSILON] == NONE)

    # Inwards the far side is met, in float64 at the larger root of |o + t w − c| = r. The discriminant, of the order of r², is known to within
    # some roundings; so is its square root, but by r² / chord. Chords shorter than the root of that are taken for the ray's own beginning.
    inwards = slope < -4.0 * EPSILON
    o, w = origin[inwards], rays.w[inwards]
    a, b = np.sum(w * w, axis=1), np.sum(o * w, axis=1)
    chord = (-b + np.sqrt(np.maximum(b * b - a * (np.sum(o * o, axis=1) - r * r), 0.0))) / a
    long = chord > 2.0 * np.sqrt(16.0 * EPSILON) * r
    assert np.all(rays.second[inwards][long] != NONE)
    assert np.all(np.abs(rays.t[inwards] - chord)[long] <= (16.0 * EPSILON * r * (1.0 + r / chord))[long])


@pytest.mark.parametrize("distance", [0.0, 1.0, 1e3])
@pytest.mark.parametrize("size", [1e-2, 1.0, 1e3])
def test_ellipsoids(device: cl.Device, size: float, distance: float) -> None:
    generator = np.random.default_rng(6)
    center = unit(generator, 1)[0] * distance
    steps = [{"scale": [2.0 * size, 0.2 * size, size]}, {"rotate": {"axis": [1, 2, 3], "angle": 70}}, {"translate": list(center)}]
    probe = Probe(device, {"scene": {"geometry": [{"type": "sphere", "transform": steps}]}}, "shade", BODY, alone=True)
    record = probe.buffers.arrays["ellipsoids"][1][0]
    c, to_world = record["center"].astype(np.float64), record["to_world"].astype(np.float64)
    away = 10.0 ** generator.uniform(0.01, 2.0, (RAYS, 1))
    rays = leave(probe, c + (unit(generator, RAYS) * away) @ to_world.T, c + (unit(generator, RAYS) * 0.97 * generator.random((RAYS, 1))) @ to_world.T)

    def height(p: Array) -> tuple[Array, Array]:
        """Over the image of the unit sphere, to first order, and the normal there."""
        n = (p - c) @ np.linalg.inv(to_world).T
        length = np.linalg.norm(n, axis=1)
        normal = (n / length[:, None]) @ np.linalg.inv(to_world)
        slope = np.linalg.norm(normal, axis=1)
        return (length - 1.0) / slope, normal / slope[:, None]

    over, normal = height(rays.p)
    check(rays, over, height(rays.origin)[0], normal, np.abs(rays.p).max(axis=1) + 2.0 * size)
    slope = np.sum(rays.w * rays.ng, axis=1)
    assert np.all(rays.second[slope > 4.0 * EPSILON] == NONE)


@pytest.mark.parametrize("distance", [0.0, 1.0, 1e3])
def test_planes(device: cl.Device, distance: float) -> None:
    generator = np.random.default_rng(2)
    point, normal = unit(generator, 2) * np.array([[distance], [1.0]])
    probe = Probe(device, {"scene": {"geometry": [{"type": "plane", "position": list(point), "normal": list(normal)}]}}, "shade", BODY, alone=True)
    record = probe.buffers.arrays["planes"][1][0]
    p0, n = record["point"].astype(np.float64), record["normal"].astype(np.float64)
    n /= np.linalg.norm(n)
    along = unit(generator, RAYS)
    along -= np.outer(along @ n, n)
    rays = leave(probe, p0 + unit(generator, RAYS) * 10.0 ** generator.uniform(-2.0, 3.0, (RAYS, 1)),
                 p0 + along * 10.0 ** generator.uniform(-2.0, 3.0, (RAYS, 1)))
    size = np.abs(rays.p).max(axis=1) + np.abs(rays.p - p0).max(axis=1)
    check(rays, (rays.p - p0) @ n, (rays.origin - p0) @ n, np.broadcast_to(n, rays.p.shape), size)
    assert np.all(rays.second == NONE)


@pytest.mark.parametrize("distance", [0.0, 1.0, 1e3])
@pytest.mark.parametrize("shape", ["disk", "ellipse"])
def test_disks(device: cl.Device, shape: str, distance: float) -> None:
    generator = np.random.default_rng(3)
    center, normal = unit(generator, 2) * np.array([[distance], [1.0]])
    stretch = [{"scale": [40.0, 0.3, 1.0]}] if shape == "ellipse" else []
    steps = [*stretch, {"rotate": {"axis": list(normal), "angle": 53}}, {"translate": list(center)}]
    probe = Probe(device, {"scene": {"geometry": [{"type": "disk", "radius": 1.5, "transform": steps}]}}, "shade", BODY, alone=True)
    record = probe.buffers.arrays["disks"][1][0]
    c, u, v = (record[name].astype(np.float64) for name in ("center", "axis_u", "axis_v"))
    n = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
    radius, phi = np.sqrt(generator.random(RAYS)) * 0.99, generator.uniform(0.0, 2.0 * np.pi, RAYS)
    targets = c + np.outer(radius * np.cos(phi), u) + np.outer(radius * np.sin(phi), v)
    # Rays nearly along the disk would miss it by their own rounding.
    towards = unit(generator, RAYS)
    towards += n * np.sign(towards @ n)[:, None]
    rays = leave(probe, targets + towards * 10.0 ** generator.uniform(-1.0, 2.0, (RAYS, 1)), targets)
    size = np.abs(c).max() + np.abs(rays.p - c).max(axis=1) + np.linalg.norm(u) + np.linalg.norm(v)
    check(rays, (rays.p - c) @ n, (rays.origin - c) @ n, np.broadcast_to(n, rays.p.shape), size)
    assert np.all(rays.second == NONE)


def sheet(size: float, center: Array, tilt: Array, cells: int = 24) -> tuple[Array, Array]:
    """Vertices (n, 3) and faces (m, 3) of a flat, tilted, unevenly cut sheet: slivers beside large triangles."""
    generator = np.random.default_rng(4)
    cuts = np.cumsum(10.0 ** generator.uniform(-3.0, 0.0, cells + 1))
    u, v = np.meshgrid(cuts / cuts[-1] - 0.5, cuts[::-1].cumsum() / cuts.sum() - 0.5, indexing="ij")
    helper = np.linalg.qr(np.stack([tilt, [0.3, 1.0, 0.2], [1.0, 0.1, -0.4]], axis=1))[0]
    vertices = center + size * (u[..., None] * helper[:, 1] + v[..., None] * helper[:, 2]).reshape(-1, 3)
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    a, b, c, d = corner, corner + 1, corner + cells + 2, corner + cells + 1
    return vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


@pytest.mark.parametrize("distance", [0.0, 1.0, 1e3])
@pytest.mark.parametrize("size", [1.0, 1e3])
def test_triangles(device: cl.Device, size: float, distance: float) -> None:
    """A tilted sheet of slivers and large triangles, so flat that rays along it pass its neighbours by a rounding."""
    generator = np.random.default_rng(5)
    center, tilt = unit(generator, 2) * np.array([[distance], [1.0]])
    vertices, faces = sheet(size, center, tilt)
    probe = Probe(device, {"scene": {"geometry": [{"type": "mesh", "vertices": vertices, "faces": faces}]}}, "shade", BODY, alone=True)
    triangles = probe.buffers.arrays["triangle_vertices"][1].reshape(-1, 3, 3).astype(np.float64)
    chosen = triangles[generator.integers(0, len(triangles), RAYS)]
    targets = np.einsum("ij,ijk->ik", generator.dirichlet((1.0, 1.0, 1.0), RAYS), chosen)
    towards = unit(generator, RAYS)
    towards += tilt * np.sign(towards @ tilt)[:, None]
    rays = leave(probe, targets + size * towards * 10.0 ** generator.uniform(-1.0, 2.0, (RAYS, 1)), targets)

    def plane(primitive: Array) -> tuple[Array, Array]:
        v = triangles[primitive]
        n = np.cross(v[:, 1] - v[:, 0], v[:, 2] - v[:, 0])
        return v[:, 0], n / np.linalg.norm(n, axis=1, keepdims=True)

    v0, n = plane(rays.first)
    check(rays, np.sum((rays.p - v0) * n, axis=1), np.sum((rays.origin - v0) * n, axis=1), n,
          np.abs(triangles[rays.first]).max(axis=(1, 2)))
    assert np.all(rays.second != rays.first)
    # Vertices are rounded: a neighbour may rise by that over the plane, and then is met where it truly is.
    met = rays.second != NONE
    v0, n = plane(rays.second[met])
    t = np.sum((v0 - rays.origin[met]) * n, axis=1) / np.sum(rays.w[met] * n, axis=1)
    assert np.all(t > 0.0)


@pytest.mark.parametrize("shape", [{"type": "sphere", "radius": 0.8}, {"type": "plane", "normal": [0.3, 1, -0.2]}, {"type": "disk", "normal": [0.3, 1, -0.2]}],
                         ids=lambda shape: shape["type"])
def test_origin_on_the_surface_is_not_met(device: cl.Device, shape: dict[str, object]) -> None:
    """A ray that starts at the point itself, not moved off by its error, does not meet what it leaves either: tests know their own rounding.

    So it is about the origin, where a point is known as well as its place on the shape.
    """
    generator = np.random.default_rng(7)
    probe = Probe(device, {"scene": {"geometry": [shape]}}, "shade",
                  BODY.replace("offset_origin(surface.p, surface.error, surface.ng, w)", "surface.p"), alone=True)
    targets = 0.6 * unit(generator, RAYS)
    if shape["type"] != "sphere":
        n = np.array([0.3, 1.0, -0.2]) / np.linalg.norm([0.3, 1.0, -0.2])
        targets -= np.outer(targets @ n, n)
    rays = leave(probe, targets + 5.0 * unit(generator, RAYS), targets)
    slope = np.sum(rays.w * rays.ng, axis=1)
    outwards = slope > 4.0 * EPSILON if shape["type"] == "sphere" else np.abs(slope) > 4.0 * EPSILON
    assert np.all(rays.second[outwards] == NONE)
