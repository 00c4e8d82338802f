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
