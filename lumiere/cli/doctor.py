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
    from lumiere.doctor.report import Outcome, carry_out, line, report
    from lumiere.film.atomic import check_writable, replacing

    path = Path(options.output)
    check_writable(path)
    device = choose(options.device)
    sys.stdout.write(f"on {device.name.strip()}\n")
    done: list[Outcome] = []

    def write(under_way: str | None) -> None:
        with replacing(path) as temporary:
            temporary.write_text("\n".join(report(done, under_way, device)) + "\n", encoding="utf-8")

    for name, check in CHECKS.items():
        write(name)  # a driver that takes the process with it leaves this
        done.append(carry_out(name, check, options.device))
        sys.stdout.write(line(done[-1]) + "\n")
        sys.stdout.flush()
    write(None)
    failed = [outcome.name for outcome in done if not outcome.finding.passed]
    verdict = f"this machine does not render correctly; failed: {', '.join(failed)}" if failed else "all is well"
    sys.stdout.write(f"{verdict}; wrote {path}\n")
    return FAILED if failed else 0
