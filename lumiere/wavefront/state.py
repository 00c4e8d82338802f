"""Path state: one list of fields, one array a field.

The list is the documentation: what a path carries, and which feature of the scene makes it carry that. Fields of features that the scene does not
have take no bytes.
"""

from __future__ import annotations

from dataclasses import dataclass

from lumiere.compile.features import Features


@dataclass(frozen=True)
class PathField:
    """A field of a path: ``kind`` is ``float``, ``float3`` or ``uint``; present where ``feature`` (of Features) is set, or always."""

    name: str
    kind: str
    doc: str
    feature: str = ""

    @property
    def size(self) -> int:
        """4-byte words."""
        return 3 if self.kind == "float3" else 1


PATH_FIELDS = (
    PathField("sample", "uint", "place in the batch's sample buffer"),
    PathField("seed", "uint", "of the pixel's random numbers"),
    PathField("index", "uint", "of the sample in its pixel"),
    PathField("depth", "uint", "scattering events so far"),
    PathField("origin", "float3", "of the ray"),
    PathField("direction", "float3", "of the ray, unit"),
    PathField("throughput", "float3", "product of the BSDF weights and of the roulette's"),
    PathField("bsdf_pdf", "float", "density of the direction over solid angle; 0 from the camera or a specular lobe", "bsdf_pdf"),
    PathField("eta_scale", "float", "product of η² over the interfaces crossed", "eta_scale"),
    PathField("cone_width", "float", "diameter of the ray's cone at the origin, metres (lib/cone.cl)", "ray_cones"),
    PathField("cone_spread", "float", "growth of that diameter by distance", "ray_cones"),
    *(PathField(f"interior_{i}", "uint", "a body that the path is in (lib/interiors.cl)", "nested") for i in range(4)),
    PathField("extinction", "float3", "σt of the body that the path is in, 1 / metre; 0 outside of bodies", "subsurface"),
    PathField("scattering_albedo", "float3", "of one scattering event in that body", "subsurface"),
    PathField("asymmetry", "float", "mean cosine of the scattering angle there", "subsurface"),
    PathField("steps", "uint", "scattering events in the body since the last surface", "subsurface"),
    PathField("primitive", "uint", "that the ray met"),
    PathField("object", "uint", "row of the object table that shades the meeting", "mixes"),
    PathField("hit", "float3", "t, u, v of the meeting"),
    PathField("shadow_origin", "float3", "of the shadow ray", "next_event_estimation"),
    PathField("shadow_direction", "float3", "of the shadow ray; to the light's point, or unit for an infinite light", "next_event_estimation"),
    PathField("shadow_t_max", "float", "of the shadow ray: 1, or infinity", "next_event_estimation"),
    PathField("contribution", "float3", "what the shadow ray adds where nothing is in its way", "next_event_estimation"),
    PathField("light_pdf", "float", "density of the shadow ray's direction as light sampling has it, over solid angle", "traced"),
    PathField("light_bsdf_pdf", "float", "and as BSDF sampling has it", "traced"),
)


def path_fields(features: Features) -> list[PathField]:
    """The fields that a scene with ``features`` needs."""
    return [field for field in PATH_FIELDS if not field.feature or getattr(features, field.feature)]


def words_per_path(features: Features) -> tuple[int, int]:
    """4-byte words a path: of floats, and of unsigned integers."""
    fields = path_fields(features)
    return (sum(f.size for f in fields if f.kind != "uint"), sum(f.size for f in fields if f.kind == "uint"))


def path_source(features: Features, *, lanes: bool) -> str:
    """``lib/path.cl``: the type path_t and a getter and a setter for each field; with ``lanes`` also for sixteen slots from ``slot`` on, of which those
    that the mask names are set.
    """
    text = ['#include "lib/lanes.cl"\n' * lanes + "typedef struct {\n    global float *floats;\n    global uint *uints;\n    uint stride;\n} path_t;\n"]
    offsets = {"float": 0, "uint": 0}
    for field in path_fields(features):
        words = "uint" if field.kind == "uint" else "float"
        first = offsets[words]
        offsets[words] += field.size
        at = [f"path->{words}s[(size_t){first + i}u * path->stride + slot]" for i in range(field.size)]
        value = at[0] if field.size == 1 else f"(float3)({', '.join(at)})"
        sets = f"{at[0]} = value;" if field.size == 1 else " ".join(f"{a} = value.{c};" for a, c in zip(at, "xyz", strict=True))
        text.append(f"// {field.doc}\n"
                    f"static inline {field.kind} path_get_{field.name}(const path_t *path, uint slot) {{ return {value}; }}\n"
                    f"static inline void path_set_{field.name}(const path_t *path, uint slot, {field.kind} value) {{ {sets} }}\n")
        if lanes:
            wide = {"float": "float16", "uint": "uint16", "float3": "float3_lanes"}[field.kind]
            at = [f"path->{words}s + (size_t){first + i}u * path->stride + slot" for i in range(field.size)]
            value = f"load_{words}_lanes({at[0]})" if field.size == 1 else f"load3_lanes({', '.join(at)})"
            values = ["value"] if field.size == 1 else [f"value.{c}" for c in "xyz"]
            sets = " ".join(f"store_{words}_lanes({a}, mask, {v});" for a, v in zip(at, values, strict=True))
            text.append(f"static inline {wide} path_get_{field.name}_lanes(const path_t *path, uint slot) {{ return {value}; }}\n"
                        f"static inline void path_set_{field.name}_lanes(const path_t *path, uint slot, int16 mask, {wide} value) {{ {sets} }}\n")
    return "\n".join(text)
