"""Loads a scene from a file or a dict."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from lumiere.bsdf import MATERIALS
from lumiere.camera import CAMERAS
from lumiere.errors import SceneError
from lumiere.light import LIGHTS
from lumiere.registry import Registry
from lumiere.scene.describe import did_you_mean, found, one_of
from lumiere.scene.model import Film, Integrator, Sampler, Scene
from lumiere.scene.node import Node, from_python, printable
from lumiere.scene.read import Reader
from lumiere.scene.source import parse
from lumiere.scene.unsupported import refuse_unsupported
from lumiere.shape import SHAPES
from lumiere.texture import TEXTURES

_KEYS = ("camera", "film", "integrator", "sampler", "materials", "textures", "media", "geometry", "lights")


def load(scene: str | os.PathLike[str] | dict[str, Any]) -> Scene:
    """The scene in the file called ``scene``, or in a dict of the same form: ``{"scene": {…}}``.

    File names inside are relative to the scene's file, in a dict to the working directory. Every value is checked, used or not.
    Raises SceneError, one line that says where, what was found and what was expected.
    """
    if isinstance(scene, dict):
        result = _scene(from_python(scene), Path.cwd())
        result.text_hash = hashlib.sha256(_canonical(scene)).hexdigest()
        return result
    path = Path(scene)
    data = _read(path)
    result = _scene(parse(data, str(path)), path.parent.absolute())
    result.path = path
    result.text_hash = hashlib.sha256(data).hexdigest()
    return result


def _read(path: Path) -> bytes:
    name = printable(str(path))
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise SceneError(f"{name}: found no such file, expected a scene") from None
    except IsADirectoryError:
        raise SceneError(f"{name}: found a directory, expected a scene file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(f"{name}: cannot be read ({reason}), expected a scene file") from None


def _canonical(scene: dict[str, Any]) -> bytes:
    """Bytes that are the same for equal dicts, whatever the order of their keys."""
    def plain(value: Any) -> Any:
        return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else str(value)

    return json.dumps(scene, sort_keys=True, default=plain).encode()


def _scene(document: Node, base: Path) -> Scene:
    if not isinstance(document.value, dict):
        raise document.error(f'found {found(document)}, expected {{"scene": {{…}}}}')
    _known_keys(document, ("scene",))
    node = document.value.get("scene")
    if node is None:
        raise document.error("found no 'scene', expected {\"scene\": {…}}")
    sections = _members(node)
    _known_keys(node, _KEYS)
    refuse_unsupported(node, "scene")
    _members(sections.get("media"))
    reader = Reader(base, sections.get("materials"), sections.get("textures"))

    def settings(key: str, cls: type) -> Any:
        return reader.object(sections[key], cls, key) if key in sections else cls()

    def named(key: str, registry: Registry[Any]) -> dict[str, Any]:
        return {name: reader.named(registry.noun, name, child) for name, child in _members(sections.get(key)).items()}

    def listed(key: str, registry: Registry[Any]) -> list[Any]:
        return [reader.kind(child, registry) for child in _elements(sections.get(key))]

    return Scene(
        camera=reader.kind(sections["camera"], CAMERAS, "perspective") if "camera" in sections else None,
        film=settings("film", Film), integrator=settings("integrator", Integrator), sampler=settings("sampler", Sampler),
        textures=named("textures", TEXTURES), materials=named("materials", MATERIALS),
        geometry=listed("geometry", SHAPES), lights=listed("lights", LIGHTS), places=reader.places)


def _known_keys(node: Node, known: tuple[str, ...]) -> None:
    for key, child in node.value.items():
        if key not in known:
            raise child.key_error(f"found an unknown key, expected {one_of(known)}{did_you_mean(key, known)}")


def _members(node: Node | None) -> dict[str, Node]:
    if node is not None and not isinstance(node.value, dict):
        raise node.error(f"found {found(node)}, expected an object")
    return node.value if node is not None else {}


def _elements(node: Node | None) -> list[Node]:
    if node is not None and not node.is_list:
        raise node.error(f"found {found(node)}, expected a list")
    return node.items() if node is not None else []
