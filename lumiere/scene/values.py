"""Reads values that need nothing but themselves: numbers, vectors, spectra, arrays, choices."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from lumiere.errors import SceneError
from lumiere.scene.describe import did_you_mean, expected, found
from lumiere.scene.fields import Field, Spectrum
from lumiere.scene.node import Node

LARGEST = float(np.finfo(np.float32).max)
"""Devices compute in single precision: a number beyond its range would be an infinity there."""

_HEX_COLOUR = re.compile(r"#([0-9a-fA-F]{2})([0-9a-fA-F]{2})([0-9a-fA-F]{2})")


def wrong(node: Node, field: Field) -> SceneError:
    """The error that says what ``node`` is and what ``field`` takes."""
    if node.is_number and not isinstance(node.value, int) and not math.isfinite(node.value):
        return node.error(f"found {found(node)}, expected a finite number")
    if node.is_number and abs(node.value) > LARGEST and field.kind != "integer":
        return node.error(f"found {found(node)}, expected a number that single precision holds (at most {LARGEST:.4g})")
    options = field.options if field.kind in ("choice", "choices") else ()
    return node.error(f"found {found(node)}, expected {expected(field)}{did_you_mean(node.value, options)}")


def _accepts(x: float, field: Field) -> bool:
    """In range, and finite in single precision. An open bound excludes what rounds to it, too."""
    if not abs(x) <= LARGEST:
        return False
    if field.low is not None and (x < field.low or (field.low_open and np.float32(x) <= np.float32(field.low))):
        return False
    return not (field.high is not None and (x > field.high or (field.high_open and np.float32(x) >= np.float32(field.high))))


def read_number(node: Node, field: Field) -> float:
    """A float in range."""
    if not node.is_number or not _accepts(node.value, field):
        raise wrong(node, field)
    return float(node.value)


def read_integer(node: Node, field: Field) -> int:
    """An int in range, of at most 64 bits."""
    value = node.value
    low = -(2**63) if field.low is None else field.low
    high = 2**63 - 1 if field.high is None else field.high
    if type(value) is not int or not low <= value <= high:
        raise wrong(node, field)
    return value


def read_boolean(node: Node, field: Field) -> bool:
    """True or False."""
    if not isinstance(node.value, bool):
        raise wrong(node, field)
    return node.value


def read_string(node: Node, field: Field) -> str:
    """A text."""
    if not isinstance(node.value, str):
        raise wrong(node, field)
    return node.value


def read_choice(node: Node, field: Field) -> str:
    """One of the options."""
    if not isinstance(node.value, str) or node.value not in field.options:
        raise wrong(node, field)
    return node.value


def read_choices(node: Node, field: Field) -> tuple[str, ...]:
    """Distinct options, in the order given."""
    if not node.is_list:
        raise wrong(node, field)
    one = Field("choice", options=field.options)
    chosen: list[str] = []
    for child in node.items():
        name = read_choice(child, one)
        if name in chosen:
            raise child.error(f"found {found(child)} a second time, expected each once")
        chosen.append(name)
    return tuple(chosen)


def read_vector(node: Node, field: Field) -> tuple[Any, ...]:
    """``field.size`` floats or ints; a single number for all of them where the field broadcasts."""
    element = Field("integer" if field.of is int else "number", low=field.low, high=field.high)
    read = read_integer if field.of is int else read_number
    if field.broadcast and node.is_number:
        return (read(node, element),) * (field.size or 1)
    if not node.is_list or node.length != field.size:
        raise wrong(node, field)
    return tuple(read(child, element) for child in node.items())


def srgb_to_linear(byte: int) -> float:
    """Linear value of an 8-bit sRGB-encoded one (IEC 61966-2-1:1999)."""
    x = byte / 255.0
    return x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4


def read_spectrum(node: Node, field: Field) -> Spectrum:
    """Linear Rec. 709 from a number, ``[r, g, b]`` or ``"#rrggbb"``."""
    value = node.value
    channel = Field("number", low=field.low, high=field.high)
    if isinstance(value, str):
        match = _HEX_COLOUR.fullmatch(value)
        if match is None:
            raise wrong(node, field)
        red, green, blue = (srgb_to_linear(int(digits, 16)) for digits in match.groups())
        if not all(_accepts(x, channel) for x in (red, green, blue)):
            raise wrong(node, field)
        return red, green, blue
    if node.is_list and node.length == 3:
        red, green, blue = (read_number(child, channel) for child in node.items())
        return red, green, blue
    if not node.is_number or not _accepts(value, channel):
        raise wrong(node, field)
    return (float(value),) * 3


def read_array(node: Node, field: Field) -> np.ndarray:
    """(n, size) float64, or int64 for integers, from a list of rows or one flat list."""
    if not node.is_list:
        raise wrong(node, field)
    size = field.size or 1
    data = node.plain()
    try:
        array = None if data is None else np.asarray(data, dtype=None if field.of is int else np.float64)
    except (ValueError, OverflowError):  # rows of different lengths, or integers beyond any float
        array = None
    if array is not None and array.size == 0 and array.ndim == 1:
        return np.zeros((0, size), dtype=np.int64 if field.of is int else np.float64)
    kinds = "iu" if field.of is int else "iuf"
    largest = 2**63 - 1 if field.of is int else LARGEST
    if array is None or array.dtype.kind not in kinds or (array.ndim == 2 and array.shape[1] != size):
        raise _wrong_element(node, field)
    outside = ~(np.abs(array) <= largest) if array.dtype.kind in "uf" else None
    if outside is not None and outside.any():
        index = int(np.flatnonzero(outside)[0])
        culprit = node.item(index // size).item(index % size) if array.ndim == 2 else node.item(index)
        raise wrong(culprit, Field("integer" if field.of is int else "number"))
    if array.size % size:
        raise node.error(f"found {array.size} numbers, expected {expected(field)}")
    return array.astype(np.int64 if field.of is int else np.float64).reshape(-1, size)


def _wrong_element(node: Node, field: Field) -> SceneError:
    """The error of the first element that is not as ``field`` says: neither a number in a flat list nor a row in a list of rows."""
    element = Field("integer" if field.of is int else "number")
    row = Field("vector", size=field.size, of=field.of)
    read = read_integer if field.of is int else read_number
    flat = node.length == 0 or node.item(0).is_number
    for child in node.items():
        try:
            if flat:
                read(child, element)
            else:
                read_vector(child, row)
        except SceneError as error:
            return error
    return wrong(node, field)


READ: dict[str, Callable[[Node, Field], Any]] = {
    "number": read_number,
    "integer": read_integer,
    "boolean": read_boolean,
    "string": read_string,
    "choice": read_choice,
    "choices": read_choices,
    "vector": read_vector,
    "spectrum": read_spectrum,
    "array": read_array,
}
"""The reader of each kind of field that needs nothing but its value."""
