"""``lumiere tradeoff``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from lumiere.cli.values import seconds, whole
from lumiere.errors import LumiereError


def add(subcommands: Any) -> None:
    """Declares the subcommand's arguments."""
    parser = subcommands.add_parser("tradeoff", help="measure speed against accuracy of a scene's settings", allow_abbrev=False,
                                    description="Renders a scene under everything that trades speed for accuracy, measures each against a reference, "
                                                "and says which to choose.")
    parser.add_argument("scene", metavar="SCENE", help="the scene, a JSON file")
    parser.add_argument("-o", "--output", metavar="DIR", default="tradeoff", help="folder for the tables and the page (default: tradeoff)")
    parser.add_argument("--width", metavar="W", type=whole(1, 65536), help="pixels of the picture")
    parser.add_argument("--height", metavar="H", type=whole(1, 65536), help="pixels of the picture")
    parser.add_argument("--reference", metavar="EXR", help="picture to measure against (default: rendered with the strictest settings)")
    parser.add_argument("--budget", metavar="SECONDS", type=seconds, default=150.0, help="what does not fit is left out, and named (default: 150)")
    parser.add_argument("--device", metavar="DEVICE", help="number or part of a name from `lumiere devices` (default: $LUMIERE_DEVICE, or the best)")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Measures, writes the folder and prints the table."""
    from lumiere import api
    from lumiere.tradeoff.measure import study
    from lumiere.tradeoff.report import table_text, write

    scene = api.with_options(api.load(options.scene), {"width": options.width, "height": options.height})
    folder = Path(options.output)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LumiereError(f"cannot write {folder}: {error.strerror}") from None

    def tell(step: str) -> None:
        sys.stderr.write(f"lumiere: {step}\n")
        sys.stderr.flush()

    result = study(scene, reference=Path(options.reference) if options.reference else None, budget=options.budget, device=options.device, tell=tell)
    written = write(result, folder)
    sys.stdout.write(table_text(result))
    sys.stdout.flush()
    tell(f"wrote {', '.join(map(str, written))}")
    return 0
