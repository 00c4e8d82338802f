"""The words of complaints: what was found, what was expected, what may have been meant."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from lumiere.registry import nearest
from lumiere.scene.fields import Field
from lumiere.scene.node import Node, Numbers, printable, quote

_LONGEST_LIST = 4
_LONGEST_NAMES = 24


def found(node: Node) -> str:
    """The value, shortly."""
    value = node.value
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, Numbers):
        short = len(value.data) <= _LONGEST_LIST and not hasattr(value.data[0], "__len__")
        return "[" + ", ".join(_number(x) for x in value.data) + "]" if short else f"a list of {len(value.data)}"
    if isinstance(value, list):
        return f"a list of {len(value)}" if value else "an empty list"
    if isinstance(value, str):
        return quote(value)
    return {None: "null", True: "true", False: "false"}[value] if value is None or isinstance(value, bool) else _number(value)


def _number(x: Any) -> str:
    if isinstance(x, int):
        return str(x) if x.bit_length() <= 256 else f"an integer of {x.bit_length()} bits"
    x = float(x)
    if math.isfinite(x):
        return repr(x)
    return "NaN" if math.isnan(x) else "Infinity" if x > 0 else "-Infinity"


def _bound(x: float) -> str:
    return str(int(x)) if x == int(x) and abs(x) < 1e15 else repr(x)


def bounds(field: Field) -> str:
    """The range of a field's numbers with a leading space; empty where any number will do."""
    if field.low is not None and field.high is not None:
        return f" in {'(' if field.low_open else '['}{_bound(field.low)}, {_bound(field.high)}{')' if field.high_open else ']'}"
    if field.low is not None:
        return f" {'>' if field.low_open else '>='} {_bound(field.low)}"
    return f" {'<' if field.high_open else '<='} {_bound(field.high)}" if field.high is not None else ""


def expected(field: Field) -> str:
    """What a field takes."""
    numbers = f"{'integers' if field.of is int else 'numbers'}{bounds(field)}"
    words = {
        "number": f"a number{bounds(field)}",
        "integer": f"an integer{bounds(field)}",
        "boolean": "true or false",
        "spectrum": f'a spectrum (a number, [r, g, b] or "#rrggbb"){bounds(field)}',
        "vector": f"a list of {field.size} {numbers}" + (" or a single number" if field.broadcast else ""),
        "array": f"a list of {numbers}, {field.size} a row",
        "choice": one_of(field.options),
        "choices": f"a list of some of: {', '.join(field.options)}",
        "string": "a string",
        "file": "a file's name",
        "transform": "a list of steps (objects with one of: translate, rotate, scale, look_at, matrix)",
        "texture": 'a texture ({"texture": "NAME"} or an object with a type)',
        "material": "a material (a name or an object with a type)",
        "object": "an object",
        "kind": "an object",
    }[field.kind]
    if field.textured and field.kind != "texture":
        words += " or a texture"
    return words + (" or null" if field.nullable and field.kind in ("number", "integer", "boolean", "choice") else "")


def one_of(names: Iterable[str]) -> str:
    """``one of: a, b, c``; a long list is cut."""
    names = list(names)
    cut = names[:_LONGEST_NAMES] + ["…"] * (len(names) > _LONGEST_NAMES)
    return f"one of: {', '.join(printable(name) for name in cut)}"


def did_you_mean(name: Any, known: Iterable[str]) -> str:
    """A clause that suggests the known name nearest to ``name``; empty where none is near."""
    close = nearest(name, known) if isinstance(name, str) else None
    return f"; did you mean '{printable(close)}'?" if close is not None and close != name else ""
