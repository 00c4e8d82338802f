"""``python -m lumiere``."""

import sys

from lumiere.cli.main import command

if __name__ == "__main__":
    sys.exit(command())
