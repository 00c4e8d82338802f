"""Device source: one self-contained text for a program, its includes inlined once each."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np

from lumiere.paths import cl_root, source_path

_INCLUDE = re.compile(r'^[ \t]*#include "([^"]+)"[ \t]*$', re.MULTILINE)

_C_TYPES = {"f4": "float", "i4": "int", "u4": "uint"}


@lru_cache(maxsize=256)
def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def assemble(path: str, prelude: str = "", generated: Mapping[str, str] | None = None) -> str:
    """The text of ``cl/PATH`` after ``prelude``, every ``#include`` replaced by its file's text the first time it stands, and by nothing after that.

    ``generated`` gives the texts of includes that are made for the scene (``scene/…``). Raises FileNotFoundError for an include that is in neither.
    """
    seen: set[str] = set()

    def inline(name: str) -> str:
        if name in seen:
            return ""
        seen.add(name)
        text = generated[name] if generated and name in generated else _text(source_path(name))
        return _INCLUDE.sub(lambda match: inline(match.group(1)), text)

    return prelude + inline(path)


def template(path: str) -> str:
    """The text of ``cl/PATH``, which is made to be used several times: its includes stay includes, above it."""
    text = _text(cl_root() / path)
    includes = "\n".join(match.group(0).strip() for match in _INCLUDE.finditer(text))
    return f"{includes}\n{_INCLUDE.sub('', text)}"


_OWN_NAME = re.compile(r"^(?:static inline \w+ (\w+)\(|\} (\w+);$)", re.MULTILINE)

_WIDE = {"float": "float16", "int": "int16", "bool": "int16", "uint": "uint16", "float2": "float2_lanes", "float3": "float3_lanes",
         "as_float": "as_float16", "as_int": "as_int16", "as_uint": "as_uint16", "convert_float": "convert_float_lanes",
         "convert_uint": "convert_uint_lanes", "sqrt": "sqrt_lanes"}
"""Types of a path's numbers, and functions of them → those of sixteen paths'."""


def in_lanes(*paths: str, above: str = "") -> str:
    """The text ``above`` and that of ``cl/PATH`` for sixteen paths at once (cl/lib/lanes.cl): with wide types, and each of their functions and types
    with a name that ends in _lanes.
    """
    text = "\n".join([above, *(_INCLUDE.sub("", _text(cl_root() / path)) for path in paths)])
    names = {next(filter(None, match.groups())) for match in _OWN_NAME.finditer(text)}
    renamed = _WIDE | {name: f"{name}_lanes" for name in names}
    return re.sub(rf"\b({'|'.join(sorted(renamed))})\b", lambda match: renamed[match.group(1)], text)


def c_struct(name: str, dtype: np.dtype) -> str:
    """The C declaration of ``dtype`` as the type ``name``. Fields are 4-byte scalars and arrays of them: the layout is the same everywhere."""
    lines = []
    for field in dtype.names or ():
        base, shape = dtype[field].base, dtype[field].shape
        count = int(np.prod(shape)) if shape else 0
        lines.append(f"    {_C_TYPES[base.str[1:]]} {field}{f'[{count}]' if count else ''};")
    return "typedef struct {\n" + "\n".join(lines) + f"\n}} {name};\n"
