"""``lumiere trace-path``."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from lumiere.cli.values import whole


def add(subcommands: Any) -> None:
    """Declares the subcommand's arguments."""
    parser = subcommands.add_parser("trace-path", help="replay one path and print its vertices", allow_abbrev=False,
                                    description="Replays one sample of a pixel on the device and prints what it did at each vertex.")
    parser.add_argument("scene", metavar="SCENE", help="the scene, a JSON file")
    parser.add_argument("--pixel", nargs=2, metavar=("X", "Y"), type=whole(0, 65535), required=True, help="(0, 0) is the top left")
    parser.add_argument("--sample", metavar="N", type=whole(0, 2**31 - 1), default=0, help="index of the sample (default: 0)")
    parser.add_argument("--seed", metavar="S", type=whole(0, 2**32 - 1), help="of the random numbers")
    parser.add_argument("--spp", metavar="N", type=whole(1, 2**31 - 1), help="as given to the render: the stratified sampler's strata depend on it")
    parser.add_argument("--width", metavar="W", type=whole(1, 65536), help="pixels of the whole picture")
    parser.add_argument("--height", metavar="H", type=whole(1, 65536), help="pixels of the whole picture")
    parser.add_argument("--max-depth", metavar="D", type=whole(0, 65535), help="most scattering events on a path")
    parser.add_argument("--device", metavar="DEVICE", help="number or part of a name from `lumiere devices` (default: $LUMIERE_DEVICE, or the best)")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Replays the path and prints it."""
    from lumiere import api
    from lumiere.trace.report import trace_path

    scene = api.with_options(api.load(options.scene), {name: getattr(options, name) for name in ("seed", "spp", "width", "height", "max_depth")})
    for line in trace_path(scene, tuple(options.pixel), options.sample, options.device):
        sys.stdout.write(line + "\n")
    return 0
