"""The tree of a scene file: values that know where they stand, so that every complaint can say it."""

from __future__ import annotations

import bisect
import json
import os
import re
from dataclasses import dataclass
from itertools import chain, islice, repeat
from typing import TYPE_CHECKING, Any

import numpy as np

from lumiere.errors import SceneError

if TYPE_CHECKING:
    from collections.abc import Iterator

MAX_DEPTH = 64
"""Objects and lists that may stand in each other."""

_LINE_END = re.compile(r"\r\n|\r|\n")
_NUMBER = re.compile(r"[-+0-9.eE]+")
_ROW = re.compile(r"\[[^\[\]]*\]")
_PLAIN_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_-]{0,63}")
_LONGEST_QUOTE = 60


def printable(text: str) -> str:
    """``text`` as one line: what cannot be printed becomes an escape."""
    return text if text.isprintable() else "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in text)


def quote(text: str) -> str:
    """``text`` as a short JSON string on one line."""
    short = text if len(text) <= _LONGEST_QUOTE else text[:_LONGEST_QUOTE] + "…"
    return printable(json.dumps(short, ensure_ascii=False))


@dataclass(frozen=True)
class Numbers:
    """A list of numbers, or of lists of numbers, kept as one value: a Python list or a numpy array."""

    data: Any


class Source:
    """The text of a scene file."""

    def __init__(self, name: str, text: str) -> None:
        self.name = printable(name)
        self.text = text
        self._starts: list[int] | None = None

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column, both from 1, of the character at ``offset``."""
        if self._starts is None:
            self._starts = [0, *(m.end() for m in _LINE_END.finditer(self.text))]
        line = bisect.bisect_right(self._starts, offset)
        return line, offset - self._starts[line - 1] + 1


class Node:
    """A JSON value, its place in the file and its path inside the scene.

    ``value`` is None, a bool, an int, a float, a str, a dict of nodes, a list of nodes, or ``Numbers``.
    A node made from Python objects has no ``source``.
    """

    __slots__ = ("key", "key_offset", "offset", "parent", "source", "value")

    def __init__(self, source: Source | None, offset: int, parent: Node | None, key: str | int | None, key_offset: int = 0) -> None:
        self.source = source
        self.offset = offset
        self.parent = parent
        self.key = key
        self.key_offset = key_offset
        self.value: Any = None

    @property
    def line(self) -> int | None:
        """Line of the value, from 1; None without a file."""
        return self.source.position(self.offset)[0] if self.source else None

    @property
    def column(self) -> int | None:
        """Column of the value in characters, from 1; None without a file."""
        return self.source.position(self.offset)[1] if self.source else None

    @property
    def path(self) -> str:
        """Where the value is inside the document: ``scene.geometry[3].radius``; empty for the document itself."""
        steps = []
        node: Node | None = self
        while node is not None and node.parent is not None:
            if isinstance(node.key, int):
                steps.append(f"[{node.key}]")
            else:
                plain = _PLAIN_KEY.fullmatch(str(node.key))
                steps.append(f".{node.key}" if plain else f"[{quote(str(node.key))}]")
            node = node.parent
        return "".join(reversed(steps)).removeprefix(".")

    def place(self, offset: int | None = None) -> str:
        """``FILE:LINE:COLUMN: PATH``, for the value or for the character at ``offset``; without a file, the path alone."""
        path = self.path
        if self.source is None:
            return path or "the scene"
        line, column = self.source.position(self.offset if offset is None else offset)
        return f"{self.source.name}:{line}:{column}" + (f": {path}" if path else "")

    def error(self, complaint: str, offset: int | None = None) -> SceneError:
        """The error that says ``complaint`` of this node."""
        return SceneError(f"{self.place(offset)}: {complaint}")

    def key_error(self, complaint: str) -> SceneError:
        """The error that says ``complaint`` of the key that this node is the value of."""
        return self.error(complaint, self.key_offset)

    @property
    def is_number(self) -> bool:
        """An int or a float; booleans are not numbers."""
        return type(self.value) in (int, float)

    @property
    def is_list(self) -> bool:
        """A list of anything."""
        return isinstance(self.value, (list, Numbers))

    @property
    def length(self) -> int:
        """Number of elements of a list."""
        return len(self.value.data) if isinstance(self.value, Numbers) else len(self.value)

    def item(self, index: int) -> Node:
        """One element of a list."""
        return next(self._elements(index)) if isinstance(self.value, Numbers) else self.value[index]

    def items(self) -> list[Node]:
        """The elements of a list."""
        return list(self._elements(0)) if isinstance(self.value, Numbers) else self.value

    def _elements(self, first: int) -> Iterator[Node]:
        """The elements of ``Numbers`` from the index ``first``, found again in the text."""
        data = self.value.data
        rows = isinstance(data[0], (list, tuple, np.ndarray))
        offsets: Iterator[int] = repeat(0)
        if self.source is not None:
            offsets = (match.start() for match in (_ROW if rows else _NUMBER).finditer(self.source.text, self.offset))
        for index, offset in islice(zip(range(len(data)), offsets, strict=False), first, None):
            node = Node(self.source, offset, self, index, offset)
            value = data[index]
            node.value = Numbers(value) if rows else value.item() if isinstance(value, np.generic) else value
            yield node

    def plain(self) -> Any:
        """A list of numbers, or of lists of numbers, as Python lists or a numpy array; None where the list holds anything else."""
        if isinstance(self.value, Numbers):
            return self.value.data
        if all(child.is_number for child in self.value):
            return [child.value for child in self.value]
        rows = [child.plain() if child.is_list else None for child in self.value]
        return None if any(row is None or (len(row) and not isinstance(row[0], (int, float))) for row in rows) else rows


def from_python(value: Any, parent: Node | None = None, key: str | int | None = None, depth: int = 0) -> Node:
    """The tree of a dict as the json module makes them; tuples, numpy arrays and scalars and paths are welcome too.

    Raises SceneError where a value or a key is something else, or dicts and lists are nested deeper than MAX_DEPTH.
    """
    node = Node(None, 0, parent, key)
    if isinstance(value, (np.generic, np.ndarray)) and value.ndim == 0:
        value = value.item()
    if value is None or isinstance(value, bool):
        node.value = value
    elif isinstance(value, int):
        node.value = int(value)
    elif isinstance(value, float):
        node.value = float(value)
    elif isinstance(value, str):
        node.value = str(value)
    elif isinstance(value, os.PathLike):
        node.value = str(value)
    elif depth >= MAX_DEPTH:
        raise node.error(f"found objects and lists nested deeper than {MAX_DEPTH}, expected fewer levels")
    elif isinstance(value, dict):
        for name in value:
            if not isinstance(name, str):
                raise node.error(f"found a key that is a {type(name).__name__}, expected strings")
        node.value = {str(name): from_python(child, node, str(name), depth + 1) for name, child in value.items()}
    elif isinstance(value, np.ndarray):
        numeric = value.dtype.kind in "fiu" and value.ndim <= 2 and value.size > 0
        node.value = Numbers(value) if numeric else _elements(value.tolist(), node, depth)
    elif isinstance(value, (list, tuple)):
        node.value = Numbers(value) if _numeric(value) else _elements(value, node, depth)
    else:
        raise node.error(f"found a Python {type(value).__name__}, expected what JSON can hold")
    return node


def _elements(values: Any, node: Node, depth: int) -> list[Node]:
    return [from_python(child, node, i, depth + 1) for i, child in enumerate(values)]


def _numeric(values: Any) -> bool:
    """All ints and floats, or all non-empty lists of them."""
    types = set(map(type, values))
    if types and types <= {list, tuple}:
        return all(values) and set(map(type, chain.from_iterable(values))) <= {int, float}
    return bool(types) and types <= {int, float}
