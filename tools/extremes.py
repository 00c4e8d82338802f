"""Renders the extremes on every device and prints docs/extremes.md's table: python tools/extremes.py [--effort E]."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))  # tests is no package of an installation

from lumiere.device.select import list_devices
from tests.extremes.cases import CASES


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--effort", type=float, default=1.0, help="times the samples")
    parser.add_argument("--only", default="", help="cases with this in their name")
    parser.add_argument("--device", default="", help="devices with this in their name or platform (default: all)")
    options = parser.parse_args()
    failed = 0
    for info in list_devices():
        if info.index is None or not info.matches(options.device):
            continue
        print(f"\n{info.name}, {info.platform}\n\n| case | expected | came out | as expected | seconds |\n|---|---|---|---|---|", flush=True)
        for case in CASES:
            if options.only in case.name:
                begin = time.perf_counter()
                outcome = case.run(info.index, options.effort)
                failed += not outcome.passed
                print(f"| {case.name} | {case.expected} | {outcome.text} | {'yes' if outcome.passed else '**no**'} | "
                      f"{time.perf_counter() - begin:.1f} |", flush=True)
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
