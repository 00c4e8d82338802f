"""``python -m lumiere``."""

import sys

from lumiere.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
