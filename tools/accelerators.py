"""Measures the accelerators on a device, in turn: rays a second from the camera, after a bounce and to lights, what they visit, and bytes.

    python tools/accelerators.py [SCENE] [--device D] [--layouts L …] [--width W] [--height H] [--spp N] [--repeats N] [--json F]

An accelerator is a layout, or LAYOUT_spatial for one with spatial splits. At most 7 scattering events, no roulette. All samples are in flight at once, so
that a launch of extend traces camera rays only, or rays of one bounce. Times are the device's, of kernels that also read and write the paths' state;
medians. The cost is the surface-area heuristic's, in steps, of the largest tree; not told of trees that the device builds (tools/build_trees.py has it).
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from benchmark_scene import SCENES, write  # noqa: E402
from build_trees import cost  # noqa: E402

from lumiere.accel import Accelerator, Choice  # noqa: E402
from lumiere.accel.build import Topology  # noqa: E402

MAX_DEPTH = 7
KINDS = ("camera", "bounce", "shadow")


@dataclass
class Candidate:
    """A layout with its render: what it takes, seconds of each run by kind of ray, and rays, nodes and primitives visited by kind."""

    layout: str
    render: Any
    build_seconds: float
    megabytes: float
    references: float
    cost: float | None
    seconds: list[dict[str, float]] = field(default_factory=list)
    visits: dict[str, Any] = field(default_factory=dict)

    def run(self) -> dict[str, float]:
        """One run; seconds by kind of ray, and of the whole."""
        from lumiere.profile.observe import Times

        times = Times()
        wavefront = self.render.wavefront
        self.render.restart(1)
        wavefront.finish()
        wavefront.observer = times
        self.render.run()
        wavefront.observer = None
        launches = times.launches()
        return {"camera": sum(x.seconds for x in launches if x.stage == "extend" and x.round == 0),
                "bounce": sum(x.seconds for x in launches if x.stage == "extend" and x.round > 0),
                "shadow": sum(x.seconds for x in launches if x.stage == "connect"), "all": self.render.seconds["render"]}

    def count(self) -> None:
        """The visits, in a run of its own."""
        wavefront = self.render.wavefront
        wavefront.count_visits()
        self.render.restart(1)
        self.render.run()
        nearest, shadow = wavefront.visits("extend"), wavefront.visits("connect")
        self.visits = {"camera": nearest[0], "bounce": nearest[1:].sum(axis=0), "shadow": shadow.sum(axis=0)}

    def told(self) -> dict[str, Any]:
        """All figures."""
        rows: dict[str, Any] = {"layout": self.layout, "build seconds": self.build_seconds, "megabytes": self.megabytes,
                                "references a triangle": self.references, "cost": self.cost,
                                "samples a second": self.render.samples / median(run["all"] for run in self.seconds)}
        for kind in KINDS:
            rays, nodes, primitives = (int(value) for value in self.visits[kind])
            seconds = [run[kind] for run in self.seconds]
            rows[kind] = {"rays": rays, "rays a second": rays / median(seconds), "least": rays / max(seconds), "most": rays / min(seconds),
                          "nodes a ray": nodes / max(1, rays), "primitives a ray": primitives / max(1, rays)}
        return rows


def noting_cost(choice: Choice, costs: list[tuple[int, float]]) -> Choice:
    """``choice``, but that the cost of each tree that numpy builds is appended to ``costs``, after its number of primitives."""
    def chosen(shape: str, n_primitives: int, bounded: bool, wide: bool) -> Accelerator:
        accelerator = choice(shape, n_primitives, bounded, wide)
        block, encode = getattr(getattr(accelerator, "layout", accelerator), "block", 1), accelerator.encode

        def noting(topology: Topology, records: Any) -> Any:
            costs.append((n_primitives, cost(topology, block)))
            return encode(topology, records)

        accelerator.encode = noting  # type: ignore[method-assign]
        return accelerator

    return chosen


def prepare(scene: Any, layout: str, device: str | None) -> Candidate:
    """A warm render of ``scene`` whose trees have ``layout`` where that can hold them."""
    from lumiere.accel import preferring
    from lumiere.overrides import Overrides
    from lumiere.rendering import Render

    samples = scene.film.width * scene.film.height * scene.sampler.spp
    costs: list[tuple[int, float]] = []
    render = Render(scene, device, overrides=Overrides(accelerator=noting_cost(preferring(layout), costs), slots=samples), profiling=True)
    if render.wavefront.policy.batch < samples:
        raise SystemExit(f"found {samples:,} samples, expected at most {render.wavefront.policy.batch:,} in one batch; take a smaller picture")
    buffers = render.wavefront.buffers
    trees = [name for shape in buffers.features.shapes for name in buffers.arrays
             if name.startswith(f"{shape}_") and name.removeprefix(f"{shape}_") in ("nodes", "children", "blocks", "references", "vertices")]
    references = 1.0
    if buffers.features.shared_primitives:  # words a triangle: one of references, nine of vertices
        references = 9 * buffers.arrays["triangle_references"][1].nbytes / buffers.arrays["triangle_vertices"][1].nbytes
    found = Candidate(layout, render, render.seconds["accelerator"], sum(buffers.arrays[name][1].nbytes for name in trees) / 1e6, references,
                      max(costs)[1] if costs else None)
    found.run()
    return found


def prepared(scene: Any, names: list[str], device: str | None) -> Iterator[Candidate]:
    """Those of the layouts that the device can take."""
    from lumiere.errors import DeviceError

    for layout in names:
        begin = time.perf_counter()
        try:
            yield prepare(scene, layout, device)
        except DeviceError as error:
            print(f"left out: {layout}: {error}", file=sys.stderr)
            continue
        print(f"{layout}: prepared in {time.perf_counter() - begin:.1f} s", file=sys.stderr, flush=True)


def table(rows: list[dict[str, Any]]) -> str:
    """As Markdown."""
    lines = ["| layout | build, s | MB | references | cost | " + " | ".join(f"{kind}, Mrays/s | nodes | prims" for kind in KINDS) + " | Msamples/s |",
             "|" + "---|" * (6 + 3 * len(KINDS))]
    for row in rows:
        cells = [row["layout"], f"{row['build seconds']:.3g}", f"{row['megabytes']:.4g}", f"{row['references a triangle']:.3f}",
                 "" if row["cost"] is None else f"{row['cost']:.4g}"]
        for kind in KINDS:
            part = row[kind]
            cells += [f"{part['rays a second'] / 1e6:.4g}", f"{part['nodes a ray']:.3g}", f"{part['primitives a ray']:.3g}"]
        lines.append("| " + " | ".join([*cells, f"{row['samples a second'] / 1e6:.4g}"]) + " |")
    return "\n".join(lines)


def main() -> int:
    from lumiere import api
    from lumiere.accel import names
    from lumiere.device.select import choose
    from lumiere.wavefront.policy import is_gpu

    parser = argparse.ArgumentParser(description="Measure the layouts of accelerators.")
    parser.add_argument("scene", nargs="?", default="million", help=f"a file, or one of the benchmark's: {', '.join(SCENES)} (default: million)")
    parser.add_argument("--device")
    parser.add_argument("--layouts", nargs="+", default=[name for name in names() if name != "flat"])
    parser.add_argument("--width", type=int)
    parser.add_argument("--height", type=int)
    parser.add_argument("--spp", type=int)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    device = choose(arguments.device)
    width, height, spp = (1920, 1080, 8) if is_gpu(device) else (480, 270, 4)
    size = {"width": arguments.width or width, "height": arguments.height or height, "spp": arguments.spp or spp, "max_depth": MAX_DEPTH}
    with tempfile.TemporaryDirectory() as name:
        path = write(arguments.scene, Path(name)) if arguments.scene in SCENES else Path(arguments.scene)
        scene = api.with_options(api.load(path), size)
        scene = replace(scene, integrator=replace(scene.integrator, russian_roulette_depth=None))
        candidates = list(prepared(scene, arguments.layouts, arguments.device))
    for _ in range(arguments.repeats):
        for candidate in candidates:
            candidate.seconds.append(candidate.run())
    for candidate in candidates:
        candidate.count()
    rows = [candidate.told() for candidate in candidates]
    print(f"{device.name.strip()} ({device.platform.name} {device.driver_version}), {size['width']} × {size['height']}, {size['spp']} spp\n")
    print(table(rows))
    if arguments.json:
        arguments.json.write_text(json.dumps({"device": device.name.strip(), **size, "layouts": rows}, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
