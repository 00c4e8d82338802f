"""Registries: a kind is registered by being a module of its package, or of a plug-in.

A plug-in is a distribution with an entry point in the group of the package's name (``lumiere.bsdf``, ``lumiere.light``, …) that names a module; a
``.cl`` file of the kind's name lies beside that module. docs/adding-a-material.md shows one.
"""

from __future__ import annotations

import difflib
import importlib
import pkgutil
from pathlib import Path
from typing import Generic, TypeVar

from lumiere.errors import PluginError
from lumiere.paths import plugin_folders

T = TypeVar("T")


class Registry(Generic[T]):
    """Kinds by their ``type`` name. One that has a module of its name in ``package`` costs the import of that module alone; any other name has
    every module and every plug-in imported."""

    def __init__(self, package: str, noun: str) -> None:
        self.package = package
        self.noun = noun
        self._kinds: dict[str, type[T]] = {}
        self._discovered = False

    def register(self, kind: type[T]) -> type[T]:
        """Class decorator: adds ``kind`` under its ``type``. Raises ValueError where the name is taken."""
        name = kind.type  # type: ignore[attr-defined]
        taken = self._kinds.get(name)
        if taken is not None and taken.__qualname__ != kind.__qualname__:
            raise ValueError(f"{self.noun} '{name}' is registered twice: {taken!r} and {kind!r}")
        self._kinds[name] = kind
        return kind

    def _discover(self) -> None:
        if not self._discovered:
            self._discovered = True
            package = importlib.import_module(self.package)
            for module in pkgutil.iter_modules(package.__path__):
                importlib.import_module(f"{self.package}.{module.name}")
            self._discover_plugins()

    def _discover_plugins(self) -> None:
        from importlib.metadata import entry_points

        for point in entry_points(group=self.package):
            try:
                module = importlib.import_module(point.module)
            except Exception as problem:
                reason = " ".join(f"{type(problem).__name__}: {problem}".split())
                raise PluginError(f"plug-in '{point.name}' ({point.value}): found that it cannot be imported ({reason}), "
                                  f"expected a module with a {self.noun}; repair or uninstall it") from problem
            if module.__file__ is not None:
                plugin_folders.add(Path(module.__file__).resolve().parent)

    def kinds(self) -> dict[str, type[T]]:
        """All kinds, by name, in alphabetical order."""
        self._discover()
        return dict(sorted(self._kinds.items()))

    def get(self, name: str) -> type[T] | None:
        """The kind called ``name``, or None."""
        if name not in self._kinds and not self._discovered:
            package = importlib.import_module(self.package)
            if name in (module.name for module in pkgutil.iter_modules(package.__path__)):
                importlib.import_module(f"{self.package}.{name}")
        if name not in self._kinds:
            self._discover()
        return self._kinds.get(name)


def nearest(name: str, known: object) -> str | None:
    """The known name closest to ``name``, or None where none is close."""
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=0.6)  # type: ignore[call-overload]
    return close[0] if close else None
