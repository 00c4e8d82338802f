"""``lumiere validate``."""

from __future__ import annotations

import argparse
import sys
from typing import Any


def add(subcommands: Any) -> None:
    """Declares the subcommand's arguments."""
    parser = subcommands.add_parser("validate", help="check a scene without rendering it", allow_abbrev=False,
                                    description="Reads a scene with all that it names, and says what is wrong with it, or that nothing is.")
    parser.add_argument("scene", metavar="SCENE", help="the scene, a JSON file")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Reads the scene, its meshes and its pictures. Raises SceneError for the first thing that is wrong."""
    from lumiere import api
    from lumiere.compile.scene import compile_scene
    from lumiere.compile.textures import TextureTable

    scene = api.load(options.scene)
    compile_scene(scene)
    with scene.placing_errors():
        for texture in scene.textures.values():  # also those that nothing uses
            TextureTable().id(texture)
    counts = ", ".join(f"{len(things)} {noun}{'' if len(things) == 1 else 's'}" for noun, things in (
        ("shape", scene.geometry), ("light", scene.lights), ("material", scene.materials), ("texture", scene.textures)))
    sys.stdout.write(f"{options.scene}: valid ({counts})\n")
    return 0
