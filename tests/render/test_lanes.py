"""Sixteen paths at once (cl/lib/lanes.cl): the same samples as path by path, to roundings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyopencl as cl
import pytest

from lumiere.compile.scene import compile_scene
from lumiere.overrides import Overrides
from lumiere.rendering import Render
from lumiere.scene.load import load
from lumiere.wavefront.policy import is_gpu, policy_for
from lumiere.wavefront.source import program_sources
from tests.render.scenes import Json, index_of, render

WALL: Json = {"type": "rectangle", "transform": [{"translate": [0, 0, -1]}], "material": "green"}
FLOOR: Json = {"type": "rectangle", "transform": [{"rotate": {"axis": [1, 0, 0], "angle": -90}}, {"translate": [0, -1, 0]}]}
LAMP: Json = {"type": "rectangle", "transform": [{"scale": 0.3}, {"rotate": {"axis": [1, 0, 0], "angle": 90}}, {"translate": [0, 1, 0]}], "emission": 9}
BOTH: Json = {"type": "rectangle", "transform": [{"scale": 0.2}, {"rotate": {"axis": [0, 1, 0], "angle": 70}}, {"translate": [-0.7, -0.3, 0]}],
              "material": "lantern"}
BOX: Json = {"type": "box", "transform": [{"scale": 0.3}, {"rotate": {"axis": [0, 1, 0], "angle": 20}}, {"translate": [0.4, -0.6, 0]}]}
LIGHTS = [{"type": "point", "position": [0.5, 0.8, 0.9], "intensity": 0.5},
          {"type": "spot", "position": [-0.5, 0.8, 0.9], "look_at": [0, -1, 0], "intensity": 2, "cone": 30},
          {"type": "directional", "direction": [0.2, -1, -0.3], "irradiance": 0.2},
          {"type": "directional", "direction": [-0.2, -1, -0.3], "irradiance": 0.2, "angle": 2}]
ENVIRONMENT = {"type": "environment", "radiance": [0.1, 0.2, 0.3]}


def scene(geometry: list[Json], lights: list[Json], **keys: Json) -> Json:
    return {"camera": {"position": [0, 0, 3.4], "look_at": [0, 0, 0], "fov": 40}, "film": {"width": 37, "height": 29},
            "sampler": {"spp": 16, "seed": 3}, "geometry": geometry, "lights": lights,
            "materials": {"green": {"type": "lambert", "albedo": [0.2, 0.7, 0.3]}, "glass": {"type": "dielectric"},
                          "lantern": {"type": "lambert", "emission": [3, 2, 1], "emission_sides": "both"}}} | keys


SCENES = {
    "lamps": scene([FLOOR, WALL, LAMP, BOTH, BOX], []),
    "sky": scene([FLOOR, BOX], [ENVIRONMENT]),
    "every light": scene([FLOOR, WALL, LAMP, BOX], [*LIGHTS, ENVIRONMENT]),
    "lights alone": scene([FLOOR, WALL, BOX], LIGHTS, integrator={"clamp_indirect": 0.5}),
    "roulette and glass": scene([FLOOR, WALL, LAMP, BOX | {"material": "glass"}], [ENVIRONMENT], integrator={"russian_roulette_depth": 1}),
    "no light sampling": scene([FLOOR, WALL, LAMP, BOX], [], integrator={"light_sampling": "bsdf"}),
    "light sampling alone": scene([FLOOR, WALL, LAMP, BOX], [], integrator={"light_sampling": "light"}),
    "filter": scene([FLOOR, WALL, LAMP, BOX], [], film={"width": 37, "height": 29, "filter": {"type": "gaussian"}}),
    "other numbers": scene([FLOOR, WALL, LAMP, BOX], [], sampler={"type": "independent", "spp": 16}),
    "adaptive": scene([FLOOR, WALL, LAMP, BOX], [], sampler={"spp": 16, "adaptive": {"target_error": 1e-6, "max_spp": 16}}),
    "tiny": scene([g | {"transform": [*g["transform"], {"scale": 1e-9}]} for g in (FLOOR, WALL, LAMP, BOX)], [ENVIRONMENT],
                  camera={"position": [0, 0, 3.4e-9], "look_at": [0, 0, 0], "fov": 40}),
}


@pytest.mark.parametrize("name", SCENES)
def test_as_path_by_path(device: cl.Device, name: str) -> None:
    if is_gpu(device):
        pytest.skip("lanes are for CPUs")
    in_lanes = render(device, SCENES[name])
    alone = Render(load({"scene": SCENES[name]}), index_of(device), overrides=Overrides(compacted=True))
    alone.run()
    one_by_one = alone.image({})
    same = np.isclose(in_lanes.pixels, one_by_one.pixels, rtol=1e-3, atol=1e-5).all(axis=-1)
    assert same.mean() > 0.99, f"{np.count_nonzero(~same)} of {same.size} pixels differ"  # else a rounding has sent a path another way
    assert in_lanes.pixels.mean() == pytest.approx(one_by_one.pixels.mean(), rel=2e-3)
    assert in_lanes.pixels.mean() > 0.01
    nearest, nearest_one_by_one = (image.record["rays"]["nearest"] for image in (in_lanes, one_by_one))
    assert nearest == pytest.approx(nearest_one_by_one, rel=2e-3)


@pytest.mark.parametrize("name", SCENES)
def test_these_scenes_are_shaded_in_lanes(device: cl.Device, name: str) -> None:
    """Else the test above would compare a form with itself."""
    if is_gpu(device):
        pytest.skip("lanes are for CPUs")
    buffers = compile_scene(load({"scene": SCENES[name]}), wide=True)
    for compacted in (False, True):
        policy = replace(policy_for(device, 1000, 100, 12), compacted=compacted)
        texts = {source.name: source.text for source in program_sources(buffers, policy)}
        for stage in ("generate", "shade"):
            assert (f"// {stage}, for sixteen" in texts["generate" if stage == "generate" else "shade[lambert]"]) is not compacted
