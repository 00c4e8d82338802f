"""Materials → parameter records by BSDF kind."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lumiere.bsdf import Material
from lumiere.compile.textures import TextureTable
from lumiere.texture import Texture

NO_TEXTURE = 0xFFFFFFFF


@dataclass
class MaterialTable:
    """The materials that objects use, by BSDF kind. ``textured`` says which parameters of a kind some material textures, ``features`` with which
    macros it is compiled."""

    textures: TextureTable
    compensation: bool = False
    members: dict[str, list[Material]] = field(default_factory=dict)
    parameters: dict[str, dict[str, str]] = field(default_factory=dict)
    textured: dict[str, set[str]] = field(default_factory=dict)
    features: dict[str, set[str]] = field(default_factory=dict)
    _places: dict[int, tuple[str, int]] = field(default_factory=dict)

    def place(self, material: Material) -> tuple[str, int]:
        """The BSDF kind of ``material`` and its number among the materials of that kind; it is added where it is new."""
        known = self._places.get(id(material))
        if known is not None:
            return known
        kind = material.device_kind
        members = self.members.setdefault(kind, [])
        self.parameters.setdefault(kind, {}).update(material.device_parameters)
        textured = self.textured.setdefault(kind, set())
        textured.update(name for name, value in material.device_values().items() if isinstance(value, Texture))
        compensation = {"ENERGY_COMPENSATION"} if self.compensation and material.compensates else set()
        self.features.setdefault(kind, set()).update(material.device_features, compensation)
        self._places[id(material)] = (kind, len(members))
        members.append(material)
        return self._places[id(material)]

    def dtype(self, kind: str) -> np.dtype:
        """The record of a kind: its parameters, each with a texture's id behind it where some material textures it."""
        fields: list[Any] = []
        for name, sort in self.parameters[kind].items():
            fields.append((name, "<f4", 3) if sort == "spectrum" else (name, "<f4"))
            if name in self.textured[kind]:
                fields.append((f"{name}_texture", "<u4"))
        return np.dtype(fields)

    def records(self, kind: str) -> np.ndarray:
        """(n,) records of the kind's materials."""
        records = np.zeros(len(self.members[kind]), dtype=self.dtype(kind))
        for record, material in zip(records, self.members[kind], strict=True):
            values = material.device_values()
            for name in self.parameters[kind]:
                value = values.get(name, 0.0)  # of a lobe that another material of the kind has
                textured = isinstance(value, Texture)
                if not textured:
                    record[name] = value
                if name in self.textured[kind]:
                    record[f"{name}_texture"] = self.textures.id(value) if textured else NO_TEXTURE
        return records


def _members(parameters: dict[str, str]) -> str:
    return "".join(f"    {'float3' if sort == 'spectrum' else 'float'} {name};\n" for name, sort in parameters.items())


def _bsdf_macros(kind: str, features: tuple[str, ...]) -> str:
    macros = "".join(f"#define {name}\n" for name in features)
    return (f"{macros}#define BSDF_NAME {kind}\n#define BSDF_JOIN(a, b) a##_##b\n#define BSDF_OF(a, b) BSDF_JOIN(a, b)\n"
            "#define BSDF(f) BSDF_OF(BSDF_NAME, f)\n")


def bsdf_source(kind: str, parameters: dict[str, str], textured: tuple[str, ...], features: tuple[str, ...] = ()) -> str:
    """``scene/bsdf.cl`` of a kind: NAME_t, the kind's own file, and NAME_load, which looks its textures up."""
    members = _members(parameters)
    members += "    int inside;\n" if "WALKS" in features else ""  # the path has come through the body: set by shade
    members += "    float3 share;\n    float3 spread;\n" if "DISPERSION" in features else ""  # of what the path carries, by channel; of wavelengths
    loads = []
    for name, sort in parameters.items():
        constant = f"load3(record->{name})" if sort == "spectrum" else f"record->{name}"
        if name in textured:
            look_up = "texture_value" if sort == "spectrum" else "texture_number"
            constant = (f"record->{name}_texture != NO_TEXTURE ? {look_up}(scene, record->{name}_texture, surface) : {constant}")
        loads.append(f"    bsdf.{name} = {constant};\n")
    return (_bsdf_macros(kind, features)
            + f"typedef struct {{\n{members}}} {kind}_t;\n\n"
            '#include "lib/math.cl"\n#include "lib/surface.cl"\n'
            + ('#include "lib/textures.cl"\n' if textured else "")
            + f'#include "bsdf/{kind}.cl"\n\n'
            f"static inline {kind}_t {kind}_load(const scene_t *scene, uint index, const surface_t *surface)\n{{\n"
            f"    global const {kind}_record_t *record = scene->{kind}_materials + index;\n    {kind}_t bsdf;\n"
            + "".join(loads) + "    return bsdf;\n}\n")


def bsdf_struct(kind: str, parameters: dict[str, str]) -> str:
    """The declaration of NAME_t, of a kind without features."""
    return f"typedef struct {{\n{_members(parameters)}}} {kind}_t;\n"


def bsdf_lanes_source(kind: str, parameters: dict[str, str]) -> str:
    """``scene/bsdf_lanes.cl`` of a kind without textures and features: NAME_load_lanes, which takes the places of sixteen materials."""
    numbers, values = [], []
    for name, sort in parameters.items():
        ways = [(f"{name}_{c}", f"{name}[{i}]") for i, c in enumerate("xyz")] if sort == "spectrum" else [(name, name)]
        numbers += ways
        values.append("{" + ", ".join(f"{each}.all" for each, _ in ways) + "}")
    loads = "".join(f"        {each}.lane[lane] = record->{value};\n" for each, value in numbers)
    return (_bsdf_macros(kind, ()) + '#include "scene/lanes.cl"\n\n'
            f"static inline {kind}_t_lanes {kind}_load_lanes(const scene_t *scene, const each_uint_t *material)\n{{\n"
            f"    each_float_t {', '.join(each for each, _ in numbers)};\n"
            "    for (uint lane = 0u; lane < LANES; lane++) {\n"
            f"        global const {kind}_record_t *record = scene->{kind}_materials + material->lane[lane];\n{loads}    }}\n"
            f"    const {kind}_t_lanes bsdf = {{{', '.join(values)}}};\n    return bsdf;\n}}\n")
