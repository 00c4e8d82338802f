"""Field kinds: how a class of the scene says which JSON keys it takes.

A kind is a dataclass whose attributes are declared with the functions below::

    @MATERIALS.register
    @dataclass(kw_only=True)
    class Lambert(Material):
        type: ClassVar[str] = "lambert"
        albedo: Spectrum | Texture = spectrum(0.8, high=1.0, textured=True, doc="reflected fraction")

The loader reads the declarations (``fields_of``); the reference page is made from them too.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

REQUIRED: Any = object()
"""Default of a field that the file must give."""

Spectrum = tuple[float, float, float]


@dataclass(frozen=True)
class Field:
    """One JSON key of a kind.

    ``kind`` is one of ``number``, ``integer``, ``boolean``, ``spectrum``, ``vector`` (``size`` numbers, integers where ``of`` is int),
    ``choice`` (one of ``options``), ``choices`` (any of them), ``string``, ``file``, ``transform``, ``texture``, ``material``, ``array``
    (numbers, in rows of ``size``), ``object`` (``of`` is a class) or ``kind`` (``of`` is a registry, ``default`` the type).
    ``low`` and ``high`` bound every number; an ``open`` bound is excluded.
    """

    kind: str
    default: Any = REQUIRED
    low: float | None = None
    high: float | None = None
    low_open: bool = False
    high_open: bool = False
    size: int | None = None
    options: tuple[str, ...] = ()
    of: Any = None
    textured: bool = False
    nullable: bool = False
    broadcast: bool = False
    doc: str = ""


def _declare(field: Field) -> Any:
    if field.default is REQUIRED:
        return dataclasses.field(metadata={"lumiere": field})
    default = field.default
    if field.kind == "kind":
        return dataclasses.field(default_factory=lambda: field.of.get(default)(), metadata={"lumiere": field})
    if field.kind == "object" and default is not None:
        return dataclasses.field(default_factory=field.of, metadata={"lumiere": field})
    if field.kind == "spectrum" and isinstance(default, (int, float)):
        default = (float(default),) * 3
    if isinstance(default, (list, dict)):
        return dataclasses.field(default_factory=lambda: type(default)(default), metadata={"lumiere": field})
    return dataclasses.field(default=default, metadata={"lumiere": field})


def number(default: Any = REQUIRED, *, low: float | None = None, high: float | None = None, low_open: bool = False,
           high_open: bool = False, textured: bool = False, nullable: bool = False, doc: str = "") -> Any:
    """A float; finite. ``textured``: a texture may stand for it."""
    return _declare(Field("number", default, low, high, low_open, high_open, textured=textured, nullable=nullable, doc=doc))


def integer(default: Any = REQUIRED, *, low: float | None = None, high: float | None = None, nullable: bool = False,
            doc: str = "") -> Any:
    """An int."""
    return _declare(Field("integer", default, low, high, nullable=nullable, doc=doc))


def boolean(default: Any = REQUIRED, *, nullable: bool = False, doc: str = "") -> Any:
    """A bool."""
    return _declare(Field("boolean", default, nullable=nullable, doc=doc))


def spectrum(default: Any = REQUIRED, *, low: float = 0.0, high: float | None = None, textured: bool = False,
             nullable: bool = False, doc: str = "") -> Any:
    """Linear Rec. 709, as a tuple of three floats, from a number, ``[r, g, b]`` or ``"#rrggbb"``."""
    return _declare(Field("spectrum", default, low, high, textured=textured, nullable=nullable, doc=doc))


def vector(default: Any = REQUIRED, *, size: int = 3, low: float | None = None, high: float | None = None, nullable: bool = False,
           integers: bool = False, broadcast: bool = False, doc: str = "") -> Any:
    """A tuple of ``size`` floats, or ints where ``integers``. ``broadcast``: a single number stands for ``size`` equal ones."""
    return _declare(Field("vector", default, low, high, size=size, of=int if integers else float, nullable=nullable,
                          broadcast=broadcast, doc=doc))


def choice(default: Any, options: Sequence[str], *, nullable: bool = False, doc: str = "") -> Any:
    """One of ``options``."""
    return _declare(Field("choice", default, options=tuple(options), nullable=nullable, doc=doc))


def choices(options: Sequence[str], *, doc: str = "") -> Any:
    """A tuple of distinct ``options``, empty where the file gives none."""
    return _declare(Field("choices", (), options=tuple(options), doc=doc))


def string(default: Any = REQUIRED, *, nullable: bool = False, doc: str = "") -> Any:
    """A text."""
    return _declare(Field("string", default, nullable=nullable, doc=doc))


def file(default: Any = REQUIRED, *, nullable: bool = False, doc: str = "") -> Any:
    """A file's pathlib.Path, resolved against the scene file; it exists and is a file."""
    return _declare(Field("file", default, nullable=nullable, doc=doc))


def transform(doc: str = "") -> Any:
    """A (4, 4) float64 matrix from the format's list of steps, or None where the file gives none."""
    return _declare(Field("transform", None, nullable=True, doc=doc))


def texture(doc: str = "") -> Any:
    """A texture (by name or inline) or None."""
    return _declare(Field("texture", None, nullable=True, textured=True, doc=doc))


def material(doc: str = "") -> Any:
    """A Material from its name or an inline object, or None."""
    return _declare(Field("material", None, nullable=True, doc=doc))


def nested(of: type, *, nullable: bool = False, doc: str = "") -> Any:
    """An object read by the fields of the dataclass ``of``; where not given, ``of()``, or None if ``nullable``."""
    return _declare(Field("object", None if nullable else of, of=of, nullable=nullable, doc=doc))


def kind(of: Any, default: str, *, doc: str = "") -> Any:
    """An instance of one of the kinds of the registry ``of``; ``default`` is its type where not given."""
    return _declare(Field("kind", default, of=of, doc=doc))


def array(default: Any = None, *, size: int, integers: bool = False, doc: str = "") -> Any:
    """A numpy array of shape (n, size): float64, or int64 where ``integers``; None where not given."""
    return _declare(Field("array", default, size=size, of=int if integers else float, nullable=True, doc=doc))


def fields_of(cls: type) -> dict[str, Field]:
    """The JSON keys of a kind, by name, in the order of declaration (those of base classes first)."""
    return {f.name: f.metadata["lumiere"] for f in dataclasses.fields(cls) if "lumiere" in f.metadata}
