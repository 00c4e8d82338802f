"""`lumiere tradeoff` from a checkout: speed against accuracy of a scene's settings (docs/tradeoff.md)."""

from __future__ import annotations

import sys

from lumiere.cli.main import main

if __name__ == "__main__":
    sys.exit(main(["tradeoff", *sys.argv[1:]]))
