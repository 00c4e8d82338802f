"""The text of each program: features as macros, generated declarations, and the stage's file."""

from __future__ import annotations

from lumiere.accel import PACKET_LAYOUTS
from lumiere.compile.features import FIRST_HIT_AOVS, ID_AOVS, Features
from lumiere.compile.materials import NO_TEXTURE, bsdf_source
from lumiere.compile.scene import TRANSLUCENT, TWO_SIDED, VISIBLE_TO_CAMERA, VISIBLE_TO_SHADOW, SceneBuffers
from lumiere.device.program import ProgramSource
from lumiere.device.source import assemble, c_struct, template
from lumiere.filter import TABLE_SIZE
from lumiere.wavefront import lanes
from lumiere.wavefront.batch import BATCH
from lumiere.wavefront.policy import Policy
from lumiere.wavefront.state import path_source

NON_FINITE_KEPT = 64

CHUNK = 32
"""Work-items that find their places among each other before their chunks do."""


def queue_names(features: Features) -> list[str]:
    """The queues, in the order of their numbers."""
    names = ["IDLE_0", "IDLE_1", "EXTEND_0", "EXTEND_1", "CONNECT"]
    names += ["ESCAPE"] if features.infinite_lights else []
    names += ["SCATTER"] if features.subsurface else []
    return names + [f"SHADE_{i}" for i in range(max(1, len(features.bsdfs)))]


COUNTERS = ("NEXT_SAMPLE", "RAYS", "SHADOW_RAYS", "FIRST_ROUND")


def counter_count(features: Features) -> int:
    """Words of the counter buffer: queue sizes, then COUNTERS."""
    return len(queue_names(features)) + len(COUNTERS)


def _defines(features: Features, policy: Policy) -> str:
    queues = queue_names(features)
    flags = {
        "EMISSION": features.emission, "EMITTERS": features.emitters, "TEXTURED_EMISSION": features.textured_emission,
        "PATH_BSDF_PDF": features.bsdf_pdf, "PATH_ETA_SCALE": features.eta_scale, "CAMERA_LENS": features.camera_lens,
        "CAMERA_PARTIAL": features.camera_partial, "FILTER_TABLE": features.filter_table, "CLAMP_INDIRECT": features.clamp_indirect,
        "PIXEL_LIST": features.pixel_list,
        "VISIBILITY": features.visibility, "OPACITY": features.opacity, "TEXTURED_OPACITY": features.textured_opacity,
        "NORMAL_MAP": features.normal_map, "BUMP_MAP": features.bump_map,
        "BENT_NORMALS": features.normal_map or features.bump_map or features.vertex_normals,
        "RAY_CONES": features.ray_cones, "NESTED": features.nested, "SUBSURFACE": features.subsurface,
        "TRACED": features.traced, "MIXES": features.mixes, "TEXTURED_MIXES": features.textured_mixes,
        "TRIANGLE_CORNERS": features.triangle_corners,
        "VERTEX_NORMALS": features.vertex_normals,
        "VERTEX_UVS": features.vertex_uvs, "VERTEX_COLORS": features.vertex_colors, "SURFACE_UV": features.surface_uv,
        "SURFACE_TANGENT": features.surface_tangent, "SURFACE_COLOR": features.surface_color,
        "VERTEX_LANES": lanes.used(features, policy), "RAY_PACKETS": features.ray_packets,
        "INFINITE_LIGHTS": bool(features.infinite_lights), "SAMPLER_STRATA": features.sampler == "stratified",
        "QUEUES_COMPACTED": policy.compacted, "GROUPS_LEAVE": policy.groups_leave, "CPU": not policy.groups_leave,
        f"LIGHT_SAMPLING_{features.light_sampling.upper()}": True,
        "FIRST_HIT_AOVS": any(name in FIRST_HIT_AOVS for name in features.aovs),
    }
    chunk, bases = min(CHUNK, policy.work_group), -(-len(queues) // 2) * 2
    tallies = bases + policy.work_group // 2
    channels = features.channels()
    values = {f"CHANNEL_{name.upper()}": f"{first}u" for name, first in channels.items()}
    values |= {f"QUEUE_{name}": f"{number}u" for number, name in enumerate(queues)}
    values |= {f"COUNTER_{name}": f"{len(queues) + i}u" for i, name in enumerate(COUNTERS)}
    values |= {
        "CHANNEL_COUNT": f"{features.channel_count()}u",
        "FIRST_ID_CHANNEL": f"{min([channels[name] for name in ID_AOVS if name in channels], default=features.channel_count())}u",
        "QUEUE_COUNT": f"{len(queues)}u", "SHADE_QUEUES": str(max(1, len(features.bsdfs))), "FILTER_TABLE_SIZE": f"{TABLE_SIZE}u",
        "NON_FINITE_KEPT": f"{NON_FINITE_KEPT}u", "NO_TEXTURE": f"{NO_TEXTURE}u", "OBJECT_TWO_SIDED": f"{TWO_SIDED}u",
        "OBJECT_TRANSLUCENT": f"{TRANSLUCENT}u", "OBJECT_VISIBLE_TO_CAMERA": f"{VISIBLE_TO_CAMERA}u",
        "OBJECT_VISIBLE_TO_SHADOW": f"{VISIBLE_TO_SHADOW}u",
        # One base a queue, then (compacted) two bytes a work-item, and a count a queue and chunk; the census of dense queues needs three words.
        "SCRATCH_WISHES": f"{bases}u", "SCRATCH_TALLIES": f"{tallies}u", "SCRATCH_SIZE": f"{tallies + len(queues) * policy.work_group // chunk}u",
        "CHUNK": f"{chunk}u",
        # Intel's runtime for CPUs would vectorise across work-items: traversal, which has vectors of its own, is 7 to 11 times slower then, and
        # large BSDFs overwrite each other's results (runtime 2026.22.10; docs/devices.md).
        "UNVECTORIZED": "" if policy.groups_leave else "__attribute__((vec_type_hint(float8)))",
        "WORK_GROUP_SIZE": f"{policy.work_group}u", "WORK_GROUP": f"__attribute__((reqd_work_group_size({policy.work_group}, 1, 1)))",
        "SLOT_BY_SLOT": "__attribute__((reqd_work_group_size(1, 1, 1)))",  # a work-item for the slots of a group
        "LANES_GROUP": f"__attribute__((reqd_work_group_size({max(1, policy.work_group // lanes.LANES)}, 1, 1)))",
    }
    lines = [f"#define {name}" for name, present in flags.items() if present]
    return "\n".join(lines + [f"#define {name} {value}" for name, value in values.items()]) + "\n"


TRACING = ("extend", "connect")
"""Stages that trace rays."""

VISIT_BOUNCES, VISIT_COPIES = 32, 64
"""Bounces that are told apart in counting what rays visit (the last takes those beyond it), and copies of those counts."""

_COUNTING = (f"#define COUNT_VISITS\n#define VISIT_BOUNCES {VISIT_BOUNCES}u\n#define VISIT_COPIES {VISIT_COPIES}u\n"
             "typedef struct {\n    uint nodes;\n    uint primitives;\n} visits_t;\n")


def _scene_struct(buffers: SceneBuffers, *, counting: bool = False) -> str:
    """scene_t: pointers to the scene's buffers; and the kernel parameters that every stage takes, with the text that packs them up; and where
    visits are counted (cl/accel/visits.cl) what that needs.
    """
    ray = ("    uint ray_mask;\n" if buffers.features.visibility else "") + ("    uint ray_seed;\n" if buffers.features.opacity else "")
    ray += "    visits_t *visits;\n" if counting else ""
    members = "".join(f"    global const {c_type} *{name};\n" for name, (c_type, _) in buffers.arrays.items())
    parameters = ["global float *path_floats", "global uint *path_uints", "uint path_stride", "global uint *queue_slots", "global uint *counters",
                  "uint capacity", "uint parity", "global float *sample_values", "uint sample_stride", "global const batch_t *batch"]
    parameters += [f"global const {c_type} *scene_{name}" for name, (c_type, _) in buffers.arrays.items()]
    parameters += ["global uint *visit_counts"] if counting else []
    begin = ["local uint scratch[SCRATCH_SIZE] __attribute__((aligned(8)));", "scene_t scene;", "scene.batch = batch;"]
    begin += [f"scene.{name} = scene_{name};" for name in buffers.arrays]
    begin += ["path_t path = {path_floats, path_uints, path_stride};", "samples_t samples = {sample_values, sample_stride};",
              *(["visits_t visits = {0u, 0u};", "scene.visits = &visits;"] if counting else []),
              "queues_t queues;", "queues.counters = counters;", "queues.capacity = capacity;"]
    return (_COUNTING * counting + f"typedef struct {{\n    global const batch_t *batch;\n{ray}{members}}} scene_t;\n\n"
            "typedef struct {\n    global float *values;\n    uint stride;\n} samples_t;\n\n"
            "#ifdef QUEUES_COMPACTED\n"
            "typedef struct {\n    global uint *slots;\n    global uint *counters;\n    uint capacity;\n} queues_t;\n"
            "#define QUEUES_BEGIN queues.slots = queue_slots;\n"
            "#else\n"
            "typedef struct {\n    global uint *tags;\n    global uint *connects;\n    global uint *counters;\n    uint capacity;\n} queues_t;\n"
            "#define QUEUES_BEGIN queues.tags = queue_slots; queues.connects = queue_slots + capacity;\n"
            "#endif\n\n"
            f"#define STAGE_PARAMETERS {', '.join(parameters)}\n#define STAGE_BEGIN {' '.join(begin)} QUEUES_BEGIN\n\n")


def _for_each(name: str, items: tuple[str, ...] | list[str], *, numbered: bool = False) -> str:
    calls = [f"X({i}, {item})" if numbered else f"X({item})" for i, item in enumerate(items)]
    return f"#define FOR_EACH_{name}(X) {' '.join(calls)}\n"


def _shapes(features: Features) -> str:
    text = [_for_each("SHAPE", list(features.shapes))]
    counts = template("accel/counts.cl") if features.visibility or features.opacity else ""
    for name, layout in features.shapes.items():
        each = template("accel/each.cl") if features.ray_packets and layout not in PACKET_LAYOUTS else ""
        primitive = f"scene->{name}_references[place]" if name in features.shared_primitives else "(place)"
        text.append(f'#include "shape/{name}.cl"\n')
        text.append(f"#define SHAPE {name}\n#define SHAPE_FIRST scene->render->{name}_first\n#define SHAPE_COUNT scene->render->{name}_count\n"
                    f"#define SHAPE_BUFFER(key) scene->{name}_##key\n#define SHAPE_PRIMITIVE(place) {primitive}\n{counts}{template(f'accel/{layout}.cl')}{each}"
                    "#undef SHAPE\n#undef SHAPE_FIRST\n#undef SHAPE_COUNT\n#undef SHAPE_BUFFER\n#undef SHAPE_PRIMITIVE\n")
    return "".join(text)


def generated_sources(buffers: SceneBuffers, policy: Policy) -> dict[str, str]:
    """The includes ``scene/…`` that are made for the scene, and ``lib/path.cl``."""
    features = buffers.features
    lights = "".join(f'#include "light/{kind}.cl"\n' for kind in features.lights)
    lights += '#include "light/shape.cl"\n' if features.emitters else ""
    lights += _for_each("LIGHT", features.lights) + _for_each("INFINITE_LIGHT", features.infinite_lights)
    return {
        "lib/path.cl": path_source(features, lanes=not policy.compacted),
        "scene/shapes.cl": _shapes(features),
        "scene/lights.cl": lights,
        "scene/emission.cl": '#include "lib/textures.cl"\n' if features.textured_emission else "",
        "scene/opacity.cl": '#include "lib/textures.cl"\n' if features.textured_opacity else "",
        "scene/interiors.cl": '#include "lib/interiors.cl"\n' if features.nested else "",
        "scene/walk.cl": '#include "lib/walk.cl"\n' if features.subsurface else "",
        "scene/mix.cl": '#include "lib/textures.cl"\n' if features.textured_mixes else "",
        "scene/tilt.cl": '#include "lib/textures.cl"\n' if features.normal_map or features.bump_map else "",
        "scene/textures.cl": "".join(f'#include "texture/{kind}.cl"\n' for kind in features.textures)
        + _for_each("TEXTURE", features.textures, numbered=True),
        "scene/cone.cl": '#include "lib/cone.cl"\n' if features.ray_cones else "",
        "scene/camera.cl": f'#include "camera/{features.camera}.cl"\n',
        "scene/queue.cl": f'#include "lib/queue_{"compacted" if policy.compacted else "dense"}.cl"\n',
        "scene/vertex_random.cl": f'#include "lib/vertex_random{"_lanes" if lanes.used(features, policy) else ""}.cl"\n',
        "scene/sampler.cl": f'#include "sampler/{features.sampler}.cl"\n',
    } | lanes.common(features)


def prelude(buffers: SceneBuffers, policy: Policy, *, counting: bool = False) -> str:
    """What stands above every stage that reads the scene: macros, structs, ``scene_t``; ``counting``: where visits are counted."""
    return (_defines(buffers.features, policy) + c_struct("batch_t", BATCH) + buffers.struct_source()
            + _scene_struct(buffers, counting=counting))


def program_sources(buffers: SceneBuffers, policy: Policy, *, counting: bool = False) -> list[ProgramSource]:
    """The programs of the stages that the scene needs, in the order in which they are launched; with ``counting`` those that trace count what
    rays visit.
    """
    features = buffers.features
    above, tracing = prelude(buffers, policy), prelude(buffers, policy, counting=counting)
    generated = generated_sources(buffers, policy)
    first = ("stages/generate.cl", {})
    if lanes.generates(features, policy):
        first = ("stages/generate_lanes.cl", lanes.generating(features))
    sources = [ProgramSource("generate", assemble(first[0], above, generated | first[1])),
               ProgramSource("extend", assemble("stages/extend.cl", tracing, generated))]
    if features.infinite_lights:
        sources.append(ProgramSource("escape", assemble("stages/escape.cl", above, generated)))
    if features.subsurface:
        sources.append(ProgramSource("scatter", assemble("stages/scatter.cl", above, generated)))
    for number, (kind, textured) in enumerate(features.bsdfs.items()):
        specular = kind in features.specular_bsdfs
        own = f"#define QUEUE_SHADE QUEUE_SHADE_{number}\n"
        own += "#define NEXT_EVENT_ESTIMATION\n" if features.next_event_estimation and not specular else ""
        parameters = buffers.bsdf_parameters[kind]
        if lanes.shades(features, policy, kind):
            stage, shading = "stages/shade_lanes.cl", lanes.shading(kind, parameters)
        else:
            stage, shading = "stages/shade.cl", {"scene/bsdf.cl": bsdf_source(kind, parameters, textured, features.bsdf_features[kind])}
        sources.append(ProgramSource(f"shade[{kind}]", assemble(stage, above + own, generated | shading)))
    if features.next_event_estimation:
        sources.append(ProgramSource("connect", assemble("stages/connect.cl", tracing, generated)))
    accumulate = _defines(features, policy) + c_struct("batch_t", BATCH)
    return [*sources, ProgramSource("accumulate", assemble("stages/accumulate.cl", accumulate))]
