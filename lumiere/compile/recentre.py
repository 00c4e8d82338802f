"""Scenes far from the origin, moved there in double precision: single precision is fine at the origin and coarse far away."""

from __future__ import annotations

import copy
import dataclasses

import numpy as np

from lumiere.compile.geometry import Object
from lumiere.scene.model import Scene

FAR = 8.0
"""A scene whose centre is further from the origin than so many of its radii is moved: nearer ones lose less than 10⁻⁶ of their size."""


def far_center(objects: list[Object]) -> np.ndarray | None:
    """The centre (3,) of what is bounded, where it is far from the origin beside its size; else None."""
    corners = [o.primitives.device_shape.bounds(o.primitives.records) for o in objects
               if o.primitives.device_shape.bounded and len(o.primitives.records)]
    if not corners:
        return None
    low = np.min([lower.min(axis=0) for lower, _ in corners], axis=0).astype(np.float64)
    high = np.max([upper.max(axis=0) for _, upper in corners], axis=0).astype(np.float64)
    center, radius = 0.5 * low + 0.5 * high, 0.5 * float(np.linalg.norm(high - low))
    distance = float(np.linalg.norm(center))
    return center if distance > FAR * radius and np.isfinite(distance) else None


def moved(scene: Scene, center: np.ndarray) -> Scene:
    """``scene`` with ``center`` at the origin: shapes, lights and camera are copies whose transforms and positions are moved, in float64."""
    shift = np.eye(4)
    shift[:3, 3] = -center

    def at_origin(thing: object) -> object:
        changed = copy.copy(thing)
        for name in ("position", "look_at"):
            value = getattr(thing, name, None)
            if value is not None:
                setattr(changed, name, tuple(np.asarray(value, dtype=np.float64) - center))
        return changed

    geometry = []
    for shape in scene.geometry:
        changed = copy.copy(shape)
        changed.transform = shift @ shape.matrix()
        geometry.append(changed)
    lights = []
    for light in scene.lights:
        if light.lower() is None:
            lights.append(at_origin(light) if hasattr(light, "position") else light)
            continue
        changed = copy.copy(light)
        changed.transform = shift if light.transform is None else shift @ light.transform
        lights.append(changed)
    camera = scene.camera
    if camera is not None:
        world = shift @ camera.to_world()
        camera = copy.copy(camera)
        camera.transform, camera.position, camera.look_at = world, None, None
    return dataclasses.replace(scene, geometry=geometry, lights=lights, camera=camera)
