"""``python -m lumiere``."""

from lumiere.cli.main import command

if __name__ == "__main__":
    command()
