"""Reads objects of the scene: a node's keys against the fields that a class declares."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from lumiere.bsdf import MATERIALS
from lumiere.registry import Registry
from lumiere.scene import values
from lumiere.scene.describe import did_you_mean, expected, found, one_of
from lumiere.scene.fields import REQUIRED, Field, fields_of
from lumiere.scene.node import MAX_DEPTH, Node, printable, quote
from lumiere.scene.steps import Step, compose
from lumiere.scene.transform import is_degenerate
from lumiere.scene.unsupported import UNSUPPORTED, refuse_unsupported
from lumiere.scene.values import wrong
from lumiere.texture import TEXTURES

T = TypeVar("T")

_declared = lru_cache(maxsize=None)(fields_of)


class Reader:
    """Reads the objects of one scene, whose relative file names stand for files in the folder ``base``.

    ``materials`` and ``textures`` are the scene's objects of those names; each entry is read once, when it is first asked for.
    ``places`` tells where each object, and each file's name, was read.
    """

    def __init__(self, base: Path, materials: Node | None = None, textures: Node | None = None) -> None:
        self.base = base
        self.places: dict[int, str] = {}
        self._sections = {MATERIALS.noun: (MATERIALS, materials), TEXTURES.noun: (TEXTURES, textures)}
        self._named: dict[tuple[str, str], Any] = {}
        self._being_read: list[tuple[str, str]] = []
        self._depth = 0

    def object(self, node: Node, cls: type[T], noun: str, *, ignore: tuple[str, ...] = (), name: str = "") -> T:
        """An instance of the dataclass ``cls`` from the object ``node``; ``noun`` says what it is. Keys in ``ignore`` were read already."""
        if not isinstance(node.value, dict):
            raise node.error(f"found {found(node)}, expected an object")
        refuse_unsupported(node, noun)
        fields = _declared(cls)
        given = {}
        for key, child in node.value.items():
            if key in ignore or (key not in fields and (noun, key) in UNSUPPORTED):  # the latter holds nothing, or would have been refused
                continue
            if key not in fields:
                known = [*ignore, *fields]
                raise child.key_error(f"found an unknown key, expected {one_of(known) if known else 'none'}{did_you_mean(key, known)}")
            given[key] = self.value(child, fields[key])
        for key, field in fields.items():
            if field.default is REQUIRED and key not in given:
                raise node.error(f"found no '{key}', expected {expected(field)}")
        instance = cls(**given)
        if name:
            instance.name = name  # type: ignore[attr-defined]
        check = getattr(instance, "check", None)
        complaint = check() if check is not None else None
        if complaint is not None:
            raise node.error(complaint)
        return instance

    def kind(self, node: Node, registry: Registry[T], default: str | None = None, name: str = "") -> T:
        """An instance of the kind of ``registry`` that the object's ``type`` says; of the type ``default`` where it says nothing."""
        if not isinstance(node.value, dict):
            raise node.error(f"found {found(node)}, expected an object with a type")
        refuse_unsupported(node, registry.noun)
        child = node.value.get("type")
        if child is None and default is None:
            raise node.error(f"found no 'type', expected {one_of(registry.kinds())}")
        type_name = default if child is None else child.value
        cls = registry.get(type_name) if isinstance(type_name, str) else None
        if cls is None:
            at = child if child is not None else node
            known = [*registry.kinds(), *UNSUPPORTED.get((registry.noun, "type"), ())]
            raise at.error(f"found {found(at)}, expected {one_of(registry.kinds())}{did_you_mean(type_name, known)}")
        if self._depth == MAX_DEPTH:
            raise node.error(f"found materials or textures that lead to each other over more than {MAX_DEPTH} levels, expected fewer")
        self._depth += 1
        instance = self.object(node, cls, registry.noun, ignore=("type",), name=name)
        self._depth -= 1
        self.places[id(instance)] = node.place()
        return instance

    def named(self, noun: str, name: str, user: Node) -> Any:
        """What the scene's materials or textures call ``name``; ``user`` is the node that asks."""
        registry, section = self._sections[noun]
        known = section.value if section is not None else {}
        if name not in known:
            names = one_of(known) if known else "but the scene has none"
            raise user.error(f"found {quote(name)}, expected the name of a {noun}, {names}{did_you_mean(name, known)}")
        key = (noun, name)
        if key in self._being_read:
            raise user.error(f"found {quote(name)} inside itself, expected a {noun} that does not lead back to itself")
        if key not in self._named:
            self._being_read.append(key)
            self._named[key] = self.kind(known[name], registry, name=name)
            self._being_read.pop()
        return self._named[key]

    def value(self, node: Node, field: Field) -> Any:
        """The value of one key."""
        if node.value is None and field.nullable:
            return None
        if field.textured and isinstance(node.value, dict):
            return self.texture(node, field)
        read = values.READ.get(field.kind)
        return _READ[field.kind](self, node, field) if read is None else read(node, field)

    def texture(self, node: Node, field: Field) -> Any:
        """A texture: ``{"texture": "NAME"}`` or an inline object."""
        if not isinstance(node.value, dict):
            raise wrong(node, field)
        reference = node.value.get("texture")
        if reference is None:
            if "type" not in node.value:
                raise node.error(f"found an object with neither 'texture' nor 'type', expected {expected(field)}")
            return self.kind(node, TEXTURES)
        for key, child in node.value.items():
            if key != "texture":
                raise child.key_error(f"found a key beside 'texture', expected {{\"texture\": \"NAME\"}} alone{did_you_mean(key, ['texture'])}")
        if not isinstance(reference.value, str):
            raise reference.error(f"found {found(reference)}, expected the name of a texture")
        return self.named(TEXTURES.noun, reference.value, reference)

    def material(self, node: Node, field: Field) -> Any:
        """A material: its name or an inline object."""
        if isinstance(node.value, str):
            return self.named(MATERIALS.noun, node.value, node)
        if not isinstance(node.value, dict):
            raise wrong(node, field)
        return self.kind(node, MATERIALS)

    def transform(self, node: Node, field: Field) -> np.ndarray:
        """(4, 4) float64 from a list of steps."""
        if not node.is_list:
            raise wrong(node, field)
        children = node.items()
        steps = [self.object(child, Step, "transform") for child in children]
        matrix = compose(steps)
        if not np.all(np.abs(matrix) <= values.LARGEST) or is_degenerate(matrix):
            for child, step in zip(children, steps, strict=True):
                if is_degenerate(step.to_matrix()):
                    raise child.error("found a step that flattens space, expected one that can be inverted")
            raise node.error("found steps that together flatten space or leave single precision's range, expected ones that can be inverted")
        return matrix

    def file(self, node: Node, field: Field) -> Path:
        """A file that is there."""
        name = node.value
        if not isinstance(name, str) or not name:
            raise wrong(node, field)
        path = self.base / name
        try:
            if path.is_file():
                if os.access(path, os.R_OK):
                    self.places[id(path)] = node.place()
                    return path
                raise node.error(f"found {quote(name)}, which may not be read, expected a readable file")
            missing = "is a directory" if path.is_dir() else "does not exist"
            siblings = sorted(os.listdir(path.parent)) if path.parent.is_dir() else []
        except (OSError, ValueError):
            missing, siblings = "cannot be a file", []
        raise node.error(f"found {quote(name)}, which {missing} in {printable(str(self.base))}, expected a file{did_you_mean(path.name, siblings)}")


_READ: dict[str, Callable[[Reader, Node, Field], Any]] = {
    "texture": Reader.texture,
    "material": Reader.material,
    "transform": Reader.transform,
    "file": Reader.file,
    "object": lambda reader, node, field: reader.object(node, field.of, field.of.__name__.lower()),
    "kind": lambda reader, node, field: reader.kind(node, field.of, field.default),
}
"""The fields whose values need more than themselves; ``values.READ`` has the others."""
