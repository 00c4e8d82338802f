"""``lumiere profile``."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

from lumiere.cli.values import whole
from lumiere.errors import UsageError


def add(subcommands: Any) -> None:
    """Declares the subcommand's arguments."""
    parser = subcommands.add_parser("profile", help="measure where a render's time goes", allow_abbrev=False,
                                    description="Renders a scene several times and says what each stage of the wavefront cost; or compares two "
                                                "profiles.")
    parser.add_argument("scene", metavar="SCENE", nargs="?", help="the scene, a JSON file")
    parser.add_argument("--spp", metavar="N", type=whole(1, 2**31 - 1), help="samples a pixel")
    parser.add_argument("--width", metavar="W", type=whole(1, 65536), help="pixels of the whole picture")
    parser.add_argument("--height", metavar="H", type=whole(1, 65536), help="pixels of the whole picture")
    parser.add_argument("--device", metavar="DEVICE", help="number or part of a name from `lumiere devices` (default: $LUMIERE_DEVICE, or the best)")
    parser.add_argument("--accelerator", metavar="LAYOUT", help="layout, as cwbvh, of the trees of all that it can hold; bvh2_spatial, bvh8_spatial: with "
                                                                            "spatial splits (default: the device's own)")
    parser.add_argument("--json", metavar="FILE", help="write all figures, for --compare")
    parser.add_argument("--html", metavar="FILE", help="write a page with timelines and the population by round")
    parser.add_argument("--trace", metavar="FILE", help="write a trace for Perfetto or chrome://tracing")
    parser.add_argument("--compare", nargs=2, metavar=("A.json", "B.json"), help="render nothing: print the ratios of two profiles")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Measures, prints the table and writes what was asked for; or compares."""
    from lumiere.profile.report import compare_text, read_summary

    if (options.scene is None) == (options.compare is None):
        found = "neither a scene nor --compare" if options.scene is None else "a scene and --compare"
        raise UsageError(f"found {found}, expected one of them; see `lumiere profile --help`")
    if options.compare is not None:
        sys.stdout.write(compare_text(*(read_summary(Path(name)) for name in options.compare)))
        return 0
    return _profile(options)


def _profile(options: argparse.Namespace) -> int:
    from lumiere import api
    from lumiere.accel import preferring
    from lumiere.film.atomic import check_writable, replacing
    from lumiere.overrides import Overrides
    from lumiere.profile.measure import measure
    from lumiere.profile.page import page
    from lumiere.profile.report import summary_json, table_text, trace_json
    from lumiere.profile.summary import summary

    wanted = [Path(name) for name in (options.json, options.html, options.trace) if name is not None]
    for path in wanted:
        check_writable(path)
    if len({path.resolve() for path in [*wanted, Path(options.scene)]}) <= len(wanted):
        raise UsageError("found one file named twice, expected different files for the scene and for each output")

    def tell(step: str) -> None:
        sys.stderr.write(f"lumiere: {step}\n")
        sys.stderr.flush()

    overrides = Overrides() if options.accelerator is None else Overrides(accelerator=preferring(options.accelerator))
    begin = time.perf_counter()
    scene = api.with_options(api.load(options.scene), {"spp": options.spp, "width": options.width, "height": options.height})
    profile = measure(scene, options.device, time.perf_counter() - begin, tell, overrides)
    told = summary(profile)
    sys.stdout.write(table_text(told))
    sys.stdout.flush()
    texts = [(options.json, lambda: summary_json(told)), (options.html, lambda: page(profile, told)), (options.trace, lambda: trace_json(profile))]
    for name, text in texts:
        if name is not None:
            with replacing(name) as temporary:
                temporary.write_text(text(), encoding="utf-8")
            tell(f"wrote {name}")
    return 0
