"""Sixteen paths at once (cl/lib/lanes.cl): the same samples as path by path, to roundings."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from lumiere import rendering
from lumiere.accel import PACKET_LAYOUTS
from lumiere.compile.scene import compile_scene
from lumiere.device.source import assemble, in_lanes
from lumiere.overrides import Overrides
from lumiere.paths import cl_root
from lumiere.rendering import Render
from lumiere.scene.load import load
from lumiere.wavefront import lanes, policy
from lumiere.wavefront.policy import is_gpu, policy_for
from lumiere.wavefront.source import program_sources
from tests.contexts import context_of
from tests.render.probe import Probe
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
    "every shape": scene([FLOOR, WALL, LAMP, {"type": "sphere", "position": [0.4, -0.6, 0], "radius": 0.3},
                          {"type": "plane", "position": [0, 1.5, 0], "normal": [0, -1, 0]},
                          {"type": "sphere", "transform": [{"scale": [0.2, 0.3, 0.1]}, {"translate": [-0.5, -0.4, 0.3]}]},
                          {"type": "disk", "position": [-0.9, 0, 0], "normal": [1, 0, 0], "radius": 0.4, "emission": 2},
                          {"type": "sphere", "position": [-0.2, 0.3, 0.3], "radius": 0.1, "emission": [5, 4, 3]}], [LIGHTS[0], ENVIRONMENT]),
    "tiny": scene([g | {"transform": [*g["transform"], {"scale": 1e-9}]} for g in (FLOOR, WALL, LAMP, BOX)], [ENVIRONMENT],
                  camera={"position": [0, 0, 3.4e-9], "look_at": [0, 0, 0], "fov": 40}),
}


@pytest.mark.parametrize("name", SCENES)
def test_as_path_by_path(device: cl.Device, name: str) -> None:
    if is_gpu(device):
        pytest.skip("lanes are for CPUs")
    sixteen = render(device, SCENES[name])
    alone = Render(load({"scene": SCENES[name]}), index_of(device), overrides=Overrides(compacted=True))
    alone.run()
    one_by_one = alone.image({})
    same = np.isclose(sixteen.pixels, one_by_one.pixels, rtol=1e-3, atol=1e-5).all(axis=-1)
    assert same.mean() > 0.99, f"{np.count_nonzero(~same)} of {same.size} pixels differ"  # else a rounding has sent a path another way
    assert sixteen.pixels.mean() == pytest.approx(one_by_one.pixels.mean(), rel=2e-3)
    assert sixteen.pixels.mean() > 0.01
    nearest, nearest_one_by_one = (image.record["rays"]["nearest"] for image in (sixteen, one_by_one))
    assert nearest == pytest.approx(nearest_one_by_one, rel=2e-3)


@pytest.mark.parametrize("name", SCENES)
def test_these_scenes_are_shaded_in_lanes(device: cl.Device, name: str) -> None:
    """Else the test above would compare a form with itself."""
    if is_gpu(device):
        pytest.skip("lanes are for CPUs")
    buffers = compile_scene(load({"scene": SCENES[name]}), wide=True)
    for compacted in (False, True):
        wanted = replace(policy_for(device, 1000, 100, 12), compacted=compacted)
        texts = {source.name: source.text for source in program_sources(buffers, wanted)}
        for stage in ("generate", "shade"):
            assert (f"// {stage}, for sixteen" in texts["generate" if stage == "generate" else "shade[lambert]"]) is not compacted


SURFACES = """
    if (item % LANES != 0u)
        return;
    each_uint_t primitive = {0u};
    each_int_t found = {0};
    for (uint lane = 0u; lane < LANES; lane++) {
        ray_t ray;
        ray.o = vload3(2u * (item + lane), in_floats);
        ray.d = vload3(2u * (item + lane) + 1u, in_floats);
        ray.t_max = INFINITY;
        hit_t hit;
        hit.t = hit.u = hit.v = 0.0f;
        hit.primitive = 0u;
        found.lane[lane] = trace_nearest(&scene, &ray, &hit) ? -1 : 0;
        primitive.lane[lane] = hit.primitive;
        path_set_origin(&path, item + lane, ray.o);
        path_set_direction(&path, item + lane, ray.d);
        path_set_hit(&path, item + lane, (float3)(hit.t, hit.u, hit.v));
        const surface_t alone = surface_at(&scene, &ray, &hit);
        vstore3(alone.p, 6u * (item + lane), out_floats);
        vstore3(alone.error, 6u * (item + lane) + 1u, out_floats);
        vstore3(alone.ng, 6u * (item + lane) + 2u, out_floats);
        out_uints[2u * (item + lane)] = (uint)found.lane[lane];
        out_uints[2u * (item + lane) + 1u] = hit.primitive;
    }
    const surface_t_lanes all = surfaces_met(&scene, &path, item, found.all, &primitive);
    for (uint lane = 0u; lane < LANES; lane++) {
        vstore3(lane_of(&all.p, lane), 6u * (item + lane) + 3u, out_floats);
        vstore3(lane_of(&all.error, lane), 6u * (item + lane) + 4u, out_floats);
        vstore3(lane_of(&all.ng, lane), 6u * (item + lane) + 5u, out_floats);
    }
"""


@pytest.mark.parametrize("name", ["every shape", "lamps"])
def test_surfaces_are_those_of_each_path(device: cl.Device, name: str) -> None:
    """Their errors too, by which rays that leave them are offset and which no picture of this size shows."""
    if is_gpu(device):
        pytest.skip("lanes are for CPUs")
    random = np.random.default_rng(11)
    rays = np.concatenate([random.uniform(-0.8, 0.8, (1024, 3)), random.normal(size=(1024, 3))], axis=1)
    rays[:, 3:] /= np.linalg.norm(rays[:, 3:], axis=1, keepdims=True)
    probe = Probe(device, {"scene": SCENES[name]}, "shade[lambert]", SURFACES)
    floats, uints = probe(1024, floats=rays, out_floats=18, out_uints=2)
    met = uints[:, 0] != 0
    assert 300 < met.sum() < 1024 and len(np.unique(uints[met, 1])) > 8
    alone, together = floats[met, :9], floats[met, 9:]
    assert np.all(alone[:, 3:6].max(axis=0) > 0.0)
    np.testing.assert_allclose(together, alone, rtol=1e-5, atol=1e-7)


def test_groups_of_fewer_slots_take_the_form_for_one_path(device: cl.Device, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a device that has no groups of sixteen."""
    if is_gpu(device):
        pytest.skip("lanes are for CPUs")
    usual = render(device, SCENES["lamps"])
    for module in (policy, rendering):
        monkeypatch.setattr(module, "group_size", lambda device: 8)
    small = render(device, SCENES["lamps"])
    layouts = [image.record["features"]["shapes"]["triangle"] for image in (usual, small)]
    assert layouts[0] in PACKET_LAYOUTS and layouts[1] not in PACKET_LAYOUTS  # packets would begin beyond the last slot
    assert np.isclose(small.pixels, usual.pixels, rtol=1e-3, atol=1e-5).all(axis=-1).mean() > 0.99
    assert small.record["rays"]["nearest"] == pytest.approx(usual.record["rays"]["nearest"], rel=2e-3)


WRITTEN_FOR_LANES = {*lanes.SHADING, "lib/film.cl", "lib/sequence.cl", "lib/hash.cl", *(f"sampler/{kind}.cl" for kind in lanes.SAMPLERS),
                     *(f"bsdf/{kind}.cl" for kind in lanes.BSDFS), *(f"camera/{kind}.cl" for kind in lanes.CAMERAS)}


def test_files_written_for_lanes_say_so_and_do_not_branch() -> None:
    says = {str(path.relative_to(cl_root())) for path in cl_root().rglob("*.cl")
            if re.search(r"[Ff]or one path or sixteen \(lib/lanes\.cl\)", path.read_text(encoding="utf-8"))}
    assert says == WRITTEN_FOR_LANES
    for name in says:
        code = re.sub(r"//.*", "", (cl_root() / name).read_text(encoding="utf-8"))
        assert not re.search(r"\b(if|for|while|switch) \(|\((float|int|uint)[23]?\)\(", code), name


FORMULAS = {
    "square_to_disk": ("float2", "square_to_disk(float2_of(a, b))"),
    "square_to_cosine_hemisphere": ("float3", "square_to_cosine_hemisphere(float2_of(a, b))"),
    "square_to_hemisphere": ("float3", "square_to_hemisphere(float2_of(a, b))"),
    "square_to_sphere": ("float3", "square_to_sphere(float2_of(a, b))"),
    "square_to_triangle": ("float3", "square_to_triangle(float2_of(a, b))"),
    "offset_origin": ("float3", "offset_origin(float3_of(a, b, c), float3_of(a, a, b), unit3(float3_of(c - 0.5f, b + 0.1f, a)), float3_of(b - 0.5f, c, a))"),
    "frame_about": ("float3", "turned(unit3(float3_of(a - 0.5f, b - 0.5f, c - 0.5f)), float3_of(b, c, a))"),
    "unit_float": ("float2", "float2_of(unit_float(as_uint(a)), is_finite(a) && !is_finite(b / 0.0f) ? 1.0f : 0.0f)"),
}

TURNED = """
static inline float3 turned(float3 n, float3 v)
{
    const frame_t frame = frame_about(n);
    return add3(frame_to_local(&frame, v), frame_to_world(&frame, v));
}
"""


@pytest.mark.parametrize("name", FORMULAS)
def test_formulas_are_the_same_for_one_path_and_for_sixteen(device: cl.Device, name: str, tmp_path: Path) -> None:
    if is_gpu(device):
        pytest.skip("lanes are for CPUs")
    kind, call = FORMULAS[name]
    components = "xyz"[:int(kind[-1])]
    one = f"static inline {kind} formula(float a, float b, float c)\n{{\n    return {call};\n}}\n"
    files = ("lib/vector.cl", "lib/circle.cl", "lib/warp.cl", "lib/frame.cl", "lib/offset.cl")
    # What stands above the files is written for lanes too; here it has to stand below, so it is a file of its own.
    (tmp_path / "formula.cl").write_text(TURNED + one, encoding="utf-8")
    wide = in_lanes(*files, str(tmp_path / "formula.cl"))
    text = assemble("probe.cl", "", {"probe.cl": '#include "lib/lanes.cl"\n' + "".join(f'#include "{file}"\n' for file in files) + TURNED + one + wide + f"""
kernel void probe(global const float16 *in, global float *out)
{{
    const size_t i = get_global_id(0);
    const each_float_t a = {{in[3 * i]}}, b = {{in[3 * i + 1]}}, c = {{in[3 * i + 2]}};
    const {kind}_lanes all = formula_lanes(a.all, b.all, c.all);
    const each_float_t values[] = {{{', '.join(f'{{all.{x}}}' for x in components)}}};
    for (uint lane = 0u; lane < LANES; lane++) {{
        const {kind} alone = formula(a.lane[lane], b.lane[lane], c.lane[lane]);
        const float of[] = {{{', '.join(f'alone.{x}' for x in components)}}};
        for (uint k = 0u; k < {len(components)}u; k++) {{
            out[2u * ({len(components)}u * (LANES * i + lane) + k)] = of[k];
            out[2u * ({len(components)}u * (LANES * i + lane) + k) + 1u] = values[k].lane[lane];
        }}
    }}
}}
"""})
    context = context_of(device)
    queue = cl.CommandQueue(context)
    numbers = np.random.default_rng(5).random((64, 3, 16)).astype(np.float32)
    numbers[0, :, :4] = [[0.0, 0.5, 1.0, 0.5], [0.0, 0.5, 0.0, 0.25], [0.5, 1.0, 0.5, 0.5]]
    given = cl.Buffer(context, cl.mem_flags.COPY_HOST_PTR, hostbuf=numbers)
    results = np.zeros((64 * 16, len(components), 2), np.float32)
    taken = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, results.nbytes)
    kernel = cl.Kernel(cl.Program(context, text).build(), "probe")
    kernel.set_args(given, taken)
    cl.enqueue_nd_range_kernel(queue, kernel, (64,), (4,))
    cl.enqueue_copy(queue, results, taken)
    queue.finish()
    assert np.all(np.isfinite(results[..., 0])) and np.ptp(results[..., 0]) > 0.1
    np.testing.assert_allclose(results[..., 1], results[..., 0], rtol=2e-6, atol=1e-6)
