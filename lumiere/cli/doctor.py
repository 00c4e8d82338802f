"""``lumiere doctor``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

FAILED = 4
"""Exit status where a check failed."""


def add(subcommands: Any) -> None:
    """Declares the subcommand's arguments."""
    parser = subcommands.add_parser("doctor", help="check that this machine renders correctly", allow_abbrev=False,
                                    description="Renders what has a known outcome, says how each came out, and writes a report to attach to a bug.")
    parser.add_argument("--device", metavar="DEVICE", help="number or part of a name from `lumiere devices` (default: $LUMIERE_DEVICE, or the best)")
    parser.add_argument("-o", "--output", metavar="FILE", default="lumiere-doctor.txt", help="the report (default: lumiere-doctor.txt)")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Runs all checks; returns 0 where all passed."""
    from lumiere.device.select import choose
    from lumiere.doctor.checks import CHECKS
    from lumiere.doctor.report import line, report
    from lumiere.film.atomic import check_writable, replacing

    path = Path(options.output)
    check_writable(path)
    device = choose(options.device).name.strip()
    sys.stdout.write(f"on {device}\n")
    done = []
    for group in CHECKS:
        for check in group(options.device):
            done.append(check)
            sys.stdout.write(line(check) + "\n")
            sys.stdout.flush()
    with replacing(path) as temporary:
        temporary.write_text("\n".join(report(done, device)) + "\n", encoding="utf-8")
    failed = [check.name for check in done if not check.passed]
    sys.stdout.write((f"failed: {', '.join(failed)}" if failed else "all is well") + f"; wrote {path}\n")
    sys.stdout.flush()
    return FAILED if failed else 0
