"""`lumiere profile` from a checkout: where a render's time goes (docs/performance.md)."""

from __future__ import annotations

import sys
from pathlib import Path

# This folder holds a file that is named as the standard library's module `profile`: what looks for that must not find this one.
sys.path = [entry for entry in sys.path if Path(entry or ".").resolve() != Path(__file__).resolve().parent]

from lumiere.cli.main import main  # noqa: E402

if __name__ == "__main__":
    sys.exit(main(["profile", *sys.argv[1:]]))
