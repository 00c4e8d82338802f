"""Runs the functions of one BSDF kind on a device."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cache

import numpy as np
import pyopencl as cl

from lumiere.bsdf import Material
from lumiere.device.source import assemble
from tests.contexts import context_of

Array = np.ndarray

KERNELS = """
// Record `i` of the parameters: all items share record 0 where there is one only.
NAME_t load_parameters(global const float *parameters, uint records, uint i)
{
    global const float *p = parameters + (records > 1u ? i : 0u) * PARAMETER_FLOATS;
    NAME_t bsdf;
LOADS
    return bsdf;
}

kernel UNVECTORIZED void evaluate(global const float *parameters, uint records, global const float *wo, global const float *wi, global float *out)
{
    const uint i = get_global_id(0);
    const NAME_t bsdf = load_parameters(parameters, records, i);
    const float3 o = vload3(i, wo), w = vload3(i, wi);
    const float3 f = NAME_eval(&bsdf, o, w);
    vstore4((float4)(f, NAME_pdf(&bsdf, o, w)), i, out);
}

kernel UNVECTORIZED void sample(global const float *parameters, uint records, global const float *wo, global const float *u, global float *out)
{
    const uint i = get_global_id(0);
    const NAME_t bsdf = load_parameters(parameters, records, i);
    const bsdf_sample_t s = NAME_sample(&bsdf, vload3(i, wo), vload3(i, u));
    vstore3(s.wi, 3u * i, out);
    vstore3(s.weight, 3u * i + 1u, out);
    vstore3((float3)(s.pdf, s.eta, (float)s.specular), 3u * i + 2u, out);
}

kernel UNVECTORIZED void albedo(global const float *parameters, uint records, global float *out)
{
    const uint i = get_global_id(0);
    const NAME_t bsdf = load_parameters(parameters, records, i);
    vstore3(NAME_albedo(&bsdf), i, out);
}
"""


@dataclass
class Samples:
    """What ``Bsdf.sample`` returned: arrays over the samples."""

    wi: Array
    weight: Array
    pdf: Array
    eta: Array
    specular: Array

    @property
    def failed(self) -> Array:
        return self.pdf == 0.0


class Bsdf:
    """A BSDF kind, compiled. Directions are (n, 3) or (3,); ``parameters`` is one record (as ``pack`` makes it) or n of them."""

    def __init__(self, device: cl.Device, kind: str, parameters: dict[str, str], features: tuple[str, ...] = ()) -> None:
        self.context = context_of(device)
        self.queue = cl.CommandQueue(self.context)
        members, loads, offset = "", "", 0
        for name, sort in parameters.items():
            members += f"    {'float3' if sort == 'spectrum' else 'float'} {name};\n"
            value = f"(float3)(p[{offset}], p[{offset + 1}], p[{offset + 2}])" if sort == "spectrum" else f"p[{offset}]"
            loads += f"    bsdf.{name} = {value};\n"
            offset += 3 if sort == "spectrum" else 1
        if "WALKS" in features:
            members, loads = members + "    int inside;\n", loads + "    bsdf.inside = 0;\n"
        if "DISPERSION" in features:
            members += "    float3 share;\n    float3 spread;\n"
            loads += "    bsdf.share = (float3)(1.0f / 3.0f);\n    bsdf.spread = dispersion_spread(0.5f);\n"
        struct = "".join(f"#define {name}\n" for name in features) + f"typedef struct {{\n{members}}} {kind}_t;\n"
        struct += "#define UNVECTORIZED __attribute__((vec_type_hint(float8)))\n"  # as the stages have it on CPUs (lumiere/wavefront/source.py)
        text = assemble(f"bsdf/{kind}.cl", struct) + KERNELS.replace("LOADS\n", loads).replace("NAME", kind)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", cl.CompilerWarning)
            program = cl.Program(self.context, text.replace("PARAMETER_FLOATS", f"{offset}u")).build(["-cl-std=CL1.2"])
        self._kernels = {name: cl.Kernel(program, name) for name in ("evaluate", "sample", "albedo")}

    def _run(self, name: str, count: int, width: int, parameters: Array, *inputs: Array) -> Array:
        flags = cl.mem_flags
        parameters = np.ascontiguousarray(np.atleast_2d(parameters), np.float32)
        arrays = [np.ascontiguousarray(np.broadcast_to(a, (count, 3)), np.float32) for a in inputs]
        buffers = [cl.Buffer(self.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=a) for a in (parameters, *arrays)]
        result = np.zeros((count, width), np.float32)
        out = cl.Buffer(self.context, flags.WRITE_ONLY, result.nbytes)
        self._kernels[name](self.queue, (count,), None, buffers[0], np.uint32(len(parameters)), *buffers[1:], out)
        cl.enqueue_copy(self.queue, result, out)
        return result.astype(np.float64)

    def evaluate(self, parameters: Array, wo: Array, wi: Array) -> tuple[Array, Array]:
        """f |cos θi|, (n, 3), and the density, (n,)."""
        count = max(len(np.atleast_2d(wo)), len(np.atleast_2d(wi)))
        out = self._run("evaluate", count, 4, parameters, wo, wi)
        return out[:, :3], out[:, 3]

    def sample(self, parameters: Array, wo: Array, u: Array) -> Samples:
        out = self._run("sample", len(u), 9, parameters, wo, u)
        return Samples(out[:, :3], out[:, 3:6], out[:, 6], out[:, 7], out[:, 8] != 0.0)

    def albedo(self, parameters: Array) -> Array:
        return self._run("albedo", len(np.atleast_2d(parameters)), 3, parameters)


def pack(material: Material) -> Array:
    """The material's parameters as floats, in the order of ``device_parameters``."""
    values = material.device_values()
    return np.concatenate([np.ravel(values[name]) for name in material.device_parameters]).astype(np.float32)


@cache
def _compiled(device: cl.Device, kind: str, parameters: tuple[tuple[str, str], ...], features: tuple[str, ...]) -> Bsdf:
    return Bsdf(device, kind, dict(parameters), features)


def bsdf_of(device: cl.Device, material: Material, *, compensation: bool = True) -> Bsdf:
    """The BSDF that shades ``material``, compiled once a device, kind and set of lobes; as scenes have it, or without ``ENERGY_COMPENSATION``."""
    features = material.device_features + (("ENERGY_COMPENSATION",) if compensation and material.compensates else ())
    return _compiled(device, material.device_kind, tuple(material.device_parameters.items()), features)


def bsdf_of_kind(device: cl.Device, materials: list[Material], *, compensation: bool = True) -> tuple[Bsdf, dict[str, str]]:
    """The BSDF that shades all of ``materials``, of one device kind, with every lobe that one of them has; and its parameters."""
    parameters: dict[str, str] = {}
    features = {"ENERGY_COMPENSATION"} if compensation and any(m.compensates for m in materials) else set()
    for material in materials:
        parameters |= material.device_parameters
        features |= set(material.device_features)
    return _compiled(device, materials[0].device_kind, tuple(parameters.items()), tuple(sorted(features))), parameters


def uniform(generator: np.random.Generator, count: int, width: int = 3) -> Array:
    """Numbers as the samplers make them: multiples of 2⁻²⁴ in [0, 1)."""
    return generator.integers(0, 1 << 24, (count, width)).astype(np.float32) * np.float32(2.0**-24)


def direction(theta: float, phi: float) -> Array:
    """Unit vector at ``theta`` degrees from the normal and azimuth ``phi`` degrees."""
    theta, phi = np.radians(theta), np.radians(phi)
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
