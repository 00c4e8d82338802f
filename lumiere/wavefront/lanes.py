"""Which stages work on sixteen paths at once, in vectors, and the includes ``scene/…`` that they do it with (cl/lib/lanes.cl)."""

from __future__ import annotations

from lumiere.compile.features import FIRST_HIT_AOVS, Features
from lumiere.compile.materials import bsdf_lanes_source, bsdf_struct
from lumiere.device.source import in_lanes
from lumiere.wavefront.policy import Policy

LANES = 16

SAMPLERS, BSDFS, CAMERAS, LIGHTS = ("independent", "sobol"), ("lambert",), ("perspective",), ("environment",)
"""Kinds that have a form for sixteen paths: their files are written for lanes, and a light has a file NAME_lanes.cl beside."""

SHADING = ("lib/vector.cl", "lib/ray.cl", "lib/circle.cl", "lib/warp.cl", "lib/frame.cl", "lib/offset.cl", "lib/surface.cl", "lib/light_sample.cl",
           "lib/mis.cl", "shape/triangle_point.cl", "bsdf/contract.cl")
"""What shading takes from files that are written for lanes, in the order in which they build on each other."""


def used(features: Features, policy: Policy) -> bool:
    """Are random numbers drawn for sixteen paths at once? So it is on CPUs, which have wide vectors, with samplers that have no branches."""
    return not policy.compacted and features.sampler in SAMPLERS and policy.work_group % LANES == 0


def generates(features: Features, policy: Policy) -> bool:
    """Is there, for the camera and all that the scene's paths begin with, a form for sixteen paths?"""
    return (used(features, policy) and features.camera in CAMERAS
            and not (features.ray_cones or features.nested or features.subsurface or features.camera_partial))


def shades(features: Features, policy: Policy, kind: str) -> bool:
    """Is there, for a kind and all that the scene asks of its shading, a form for sixteen paths?"""
    other = (features.vertex_normals or features.normal_map or features.bump_map or features.ray_cones or features.nested or features.subsurface
             or features.mixes or features.textured_emission or any(name in FIRST_HIT_AOVS for name in features.aovs))
    return (used(features, policy) and kind in BSDFS and not features.bsdfs[kind] and not features.bsdf_features[kind]
            and not other)


def _lanes(*paths: str, above: str = "") -> str:
    return '#include "lib/math.cl"\n#include "lib/lanes.cl"\n' + in_lanes(*paths, above=above)


def common(features: Features) -> dict[str, str]:
    """Of every stage: random numbers, lights, rays and what they met."""
    wide, alone = ([kind for kind in features.lights if (kind in LIGHTS) == lanes] for lanes in (True, False))
    triangles = list(features.shapes) == ["triangle"]
    lights = [f'#include "light/{kind}_lanes.cl"' for kind in wide]
    if features.emitters and triangles:
        lights += ['#include "light/shape_lanes.cl"', "#define EMITTERS_IN_LANES"]
    if alone or (features.emitters and not triangles):
        lights.append("#define LIGHTS_ONE_BY_ONE")
    lights += ["#define FOR_EACH_LIGHT_IN_LANES(X) " + " ".join(f"X({kind})" for kind in wide),
               "#define FOR_EACH_LIGHT_ALONE(X) " + " ".join(f"X({kind})" for kind in alone)]
    sampler = in_lanes("lib/sequence.cl", "lib/hash.cl", f"sampler/{features.sampler}.cl")
    return {"scene/lanes.cl": _lanes("lib/vector.cl", "lib/ray.cl"), "scene/lights_lanes.cl": "\n".join(lights) + "\n",
            "scene/surfaces_met.cl": f'#include "{"shape/triangles" if triangles else "lib/surfaces"}_met.cl"\n',
            "scene/sampler_lanes.cl": '#include "lib/dimensions.cl"\n#include "lib/lanes.cl"\n' + sampler}


def generating(features: Features) -> dict[str, str]:
    """Of ``generate``."""
    return {"scene/lanes.cl": _lanes("lib/vector.cl", "lib/film.cl", f"camera/{features.camera}.cl")}


def shading(kind: str, parameters: dict[str, str]) -> dict[str, str]:
    """Of ``shade`` for a kind of BSDF and its parameters."""
    return {"scene/bsdf_lanes.cl": bsdf_lanes_source(kind, parameters),
            "scene/lanes.cl": _lanes(*SHADING, f"bsdf/{kind}.cl", above=bsdf_struct(kind, parameters))}
