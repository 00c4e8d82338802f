"""Compiles the OpenCL C of every kind, and of the scenes named, with clang: OpenCL C 1.2, all warnings, each an error.

Also checks that every file under cl/ is in some program. Without clang it says so and checks nothing.
"""

from __future__ import annotations

import itertools
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from lumiere.accel import Choice, choose, layouts, preferring
from lumiere.accel.bvh2 import Bvh2
from lumiere.accel.bvh8 import Bvh8
from lumiere.accel.cwbvh import Cwbvh
from lumiere.accel.device_build import DeviceBuilder
from lumiere.bsdf import MATERIALS
from lumiere.camera import CAMERAS
from lumiere.compile.scene import compile_scene
from lumiere.device.program import ProgramSource
from lumiere.film.image import Image
from lumiere.paths import cl_root
from lumiere.scene.fields import fields_of
from lumiere.scene.load import load
from lumiere.scene.model import AOVS, Sampler, Scene
from lumiere.wavefront.policy import Policy
from lumiere.wavefront.source import program_sources

FLAGS = ("-x", "cl", "-cl-std=CL1.2", "-Xclang", "-finclude-default-header", "-fsyntax-only", "-Wall", "-Wextra", "-Werror",
         # Every stage gets the same arguments and the same beginning, and every program the whole of each file that it includes.
         "-Wno-unused-parameter", "-Wno-unused-variable", "-Wno-unused-function")


def compiler() -> str | None:
    """The newest clang on PATH."""
    return next(filter(None, map(shutil.which, ["clang", *(f"clang-{n}" for n in range(25, 12, -1))])), None)


COLORED_PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 1
property list uchar int vertex_indices
end_header
0 0 0 255 0 0
1 0 0 0 255 0
0 1 0 0 0 255
3 0 1 2
"""


def scenes(folder: Path) -> Iterator[dict[str, Any]]:
    """Scenes that together have every kind of material, texture, light, shape, camera and sampler; their files are put in ``folder``."""
    picture, colored = folder / "picture.exr", folder / "colored.ply"
    Image(pixels=np.full((4, 8, 3), 0.5, np.float32)).save(picture)
    colored.write_text(COLORED_PLY, encoding="ascii")
    textures = {"checker": {"type": "checker", "a": 0.2, "b": 0.6, "scale": 4}, "colors": {"type": "vertex_color"},
                "picture": {"type": "image", "file": str(picture)},
                "filtered": {"type": "image", "file": str(picture), "filter": "mipmap"}, "constant": {"type": "constant", "value": 0.5}}
    plain = {name: {"type": name} for name in MATERIALS.kinds() if name not in ("mix", "conductor", "dielectric")}
    materials = plain | {
        "smooth_gold": {"type": "conductor", "metal": "gold"}, "rough_gold": {"type": "conductor", "metal": "gold", "roughness": 0.3},
        "smooth_glass": {"type": "dielectric", "priority": 1}, "wax": {"type": "subsurface", "roughness": 0},
        "rough_glass": {"type": "dielectric", "roughness": 0.3},
        "textured": {"type": "lambert", "albedo": {"texture": "checker"}, "emission": {"texture": "checker"}, "opacity": {"texture": "constant"},
                     "bump_map": {"texture": "checker"}, "normal_map": {"texture": "picture"}},
        "filtered": {"type": "lambert", "albedo": {"texture": "filtered"}}, "colored": {"type": "lambert", "albedo": {"texture": "colors"}}}
    balls = [{"type": "sphere", "position": [i, 0, 0], "radius": 0.3, "material": name} for i, name in enumerate(materials)]
    shapes = [{"type": "plane", "position": [0, -1, 0], "normal": [0, 1, 0]},
              {"type": "sphere", "transform": [{"scale": [1, 2, 3]}], "material": "textured"},
              {"type": "disk", "position": [0, 2, 0], "normal": [0, -1, 0], "radius": 1, "emission": 3},
              {"type": "rectangle", "emission": 2}, {"type": "box", "material": "textured"},
              {"type": "mesh", "file": str(colored), "material": "colored"},
              {"type": "mesh", "vertices": [[i % 7, i % 5, i % 3] for i in range(300)], "faces": [[i, i + 1, i + 2] for i in range(0, 297, 3)]}]
    lights = [{"type": "point", "position": [0, 5, 0], "intensity": 1}, {"type": "spot", "position": [0, 5, 0], "look_at": [0, 0, 0], "intensity": 1,
              "cone": 30}, {"type": "directional", "direction": [0, -1, 0], "irradiance": 1},
              {"type": "directional", "direction": [0, -1, 0], "irradiance": 1, "angle": 0.5}, {"type": "environment", "radiance": 1}]
    samplers = fields_of(Sampler)["type"].options
    for camera, sampler in itertools.zip_longest(CAMERAS.kinds(), samplers):
        yield {"scene": {"camera": {"type": camera or "perspective", "position": [0, 0, 5]} | ({"height": 2} if camera == "orthographic" else {})
                         | ({"aperture_radius": 0.1, "focus_distance": 3} if camera == "thin_lens" else {}),
                         "sampler": {"type": sampler or samplers[0]}, "film": {"aovs": list(AOVS)},
                         "textures": textures, "materials": materials, "geometry": [*balls, *shapes], "lights": lights}}
    yield {"scene": {"geometry": [{"type": "box", "emission": 1}], "lights": lights}}  # shaded in lanes (cl/lib/lanes.cl)
    few = [{"type": "box"}, {"type": "sphere", "position": [0, 2, 0], "radius": 0.5}]
    yield {"scene": {"geometry": few, "lights": [{"type": "environment", "file": str(picture)}]}}


def programs(scene: Scene, choose_accelerator: Choice = choose) -> Iterator[ProgramSource]:
    """The programs of ``scene`` for both ways of keeping queues."""
    for compacted in (False, True):
        buffers = compile_scene(scene, packets=not compacted, choose_accelerator=choose_accelerator)
        yield from program_sources(buffers, Policy(compacted=compacted, work_group=64, slots=1024, batch=1024, rounds=1))


def build_programs() -> Iterator[ProgramSource]:
    """The programs that build trees, for a work-item alone and for groups."""
    for layout in (Bvh2, Bvh8, Cwbvh):
        builder = DeviceBuilder(None, None, layout.name, layout.max_leaf_size, layout.block)
        yield from (builder.source(group, stack=8) for group in (1, 64))


def main() -> int:
    clang = compiler()
    if clang is None:
        print("check_cl: found no clang, so the OpenCL sources are not checked; get one with `apt install clang`")
        return 0
    texts: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as folder:
        own = list(scenes(Path(folder)))
        found = [programs(load(scene)) for scene in [*own, *sys.argv[1:]]]
        found += [programs(load(own[-1]), preferring(layout)) for layout in layouts()]
        for program in itertools.chain(build_programs(), *found):
            texts.setdefault(program.text, program.name)
    failed = 0
    for text, name in texts.items():
        done = subprocess.run([clang, *FLAGS, "-"], input=text, capture_output=True, text=True, check=False)
        if done.returncode:
            failed += 1
            print(f"--- {name}\n{done.stderr}")
    print(f"check_cl: {len(texts) - failed} of {len(texts)} programs compile without a warning")
    everything = "\0".join(texts)
    unused = [path for path in sorted(cl_root().rglob("*.cl"))
              if max(re.split(r'^#include .*$', path.read_text(encoding="utf-8"), flags=re.MULTILINE), key=len).strip() not in everything]
    for path in unused:
        print(f"check_cl: cl/{path.relative_to(cl_root())} is in no program; add its kind to the scenes in tools/check_cl.py")
    return 1 if failed or unused else 0


if __name__ == "__main__":
    sys.exit(main())
