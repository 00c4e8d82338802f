"""Where the package's own files are."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path


@lru_cache(maxsize=1)
def cl_root() -> Path:
    """The folder of the OpenCL sources: inside the package where it is installed, beside it in a checkout."""
    package = Path(__file__).resolve().parent
    installed = package / "cl"
    return installed if installed.is_dir() else package.parent / "cl"


plugin_folders: set[Path] = set()
"""Folders of the plug-ins that are in use."""


def source_path(name: str) -> Path:
    """The OpenCL source ``cl/NAME``; where the package has none, the file of that name beside a plug-in's module, if there is one."""
    own = cl_root() / name
    if own.is_file():
        return own
    return next((path for folder in sorted(plugin_folders) if (path := folder / Path(name).name).is_file()), own)
