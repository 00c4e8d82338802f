"""A device program that traces rays against triangles through an accelerator."""

from __future__ import annotations

from functools import cache

import numpy as np
import pyopencl as cl

from lumiere.accel import PACKET_LAYOUTS, SPATIAL, Accelerator, names, preferring
from lumiere.accel.build import Topology
from lumiere.accel.spatial import SpatialSplits
from lumiere.device.array import Array
from lumiere.device.source import assemble, in_lanes, template
from lumiere.shape.triangle import Triangle
from lumiere.wavefront.policy import is_gpu
from tests.contexts import context_of

ACCELERATORS: list[Accelerator] = [preferring(name)("triangle", 1, bounded=True, wide=True) for name in names()]
TREES = [accelerator for accelerator in ACCELERATORS if accelerator.name != "flat"]


def title(accelerator: Accelerator) -> str:
    """For a test's name."""
    return accelerator.name + SPATIAL * isinstance(accelerator, SpatialSplits)


def topology_of(accelerator: Accelerator, triangles: np.ndarray) -> Topology:
    """What ``accelerator`` builds over triangles (n, 3, 3)."""
    records = np.zeros(len(triangles), Triangle.record)
    records["vertices"] = triangles
    return accelerator.topology(Triangle, records)


SHAPE = """
#include "shape/triangle_test.cl"
#ifdef VISIBILITY
bool triangle_counts(const scene_t *scene, uint index, const ray_t *ray, const triangle_ray_t *prepared, float t_max, hit_t *candidate)
{
    return (index + scene->triangle_first) % 4u == 0u;
}
#endif
#define SHAPE triangle
#define SHAPE_FIRST scene->triangle_first
#define SHAPE_COUNT scene->triangle_count
#define SHAPE_BUFFER(key) scene->triangle_##key
#ifdef SHARED_PRIMITIVES
#define SHAPE_PRIMITIVE(place) scene->triangle_references[place]
#else
#define SHAPE_PRIMITIVE(place) (place)
#endif
"""

KERNEL = """
// Else Intel's compiler runs several rays in lockstep, five times slower.
__attribute__((vec_type_hint(float8)))
kernel void trace(%s
                  const uint count, const uint first,
                  global const float *rays, const uint ray_count, const int any_hit, global float *hits, global uint *primitives)
{
    uint i = get_global_id(0);
    if (i >= ray_count)
        return;
    scene_t scene_here = {%s count, first};
    const scene_t *scene = &scene_here;
    ray_t ray;
    ray.o = vload3(0, rays + 7 * (size_t)i);
    ray.d = vload3(0, rays + 7 * (size_t)i + 3);
    ray.t_max = rays[7 * (size_t)i + 6];
    hit_t hit;
    hit.t = ray.t_max;
    hit.u = hit.v = 0.0f;
    hit.primitive = 0xffffffffu;
    bool found = any_hit ? triangle_occluded(scene, &ray) : triangle_nearest(scene, &ray, &hit);
    hits[3 * (size_t)i] = hit.t;
    hits[3 * (size_t)i + 1] = hit.u;
    hits[3 * (size_t)i + 2] = hit.v;
    primitives[i] = any_hit ? (uint)found : found == (hit.primitive != 0xffffffffu) ? hit.primitive : 0xfffffffeu;
}
"""

PACKET_KERNEL = """
__attribute__((vec_type_hint(float8)))
kernel void trace(%s
                  const uint count, const uint first,
                  global const float *rays, const uint ray_count, const int any_hit, global float *hits, global uint *primitives)
{
    uint i = get_global_id(0);
    if (i %% LANES != 0u || i >= ray_count)
        return;
    scene_t scene_here = {%s count, first};
    const scene_t *scene = &scene_here;
    each_float_t of[7];
    for (uint lane = 0u; lane < LANES; lane++)
        for (uint k = 0u; k < 7u; k++)
            of[k].lane[lane] = i + lane < ray_count ? rays[7 * (size_t)(i + lane) + k] : 0.0f;
    const ray_t_lanes all = {{of[0].all, of[1].all, of[2].all}, {of[3].all, of[4].all, of[5].all}, of[6].all};
    packet_t packet;
    packet_set(&packet, -1, &all);
    if (any_hit)
        triangle_occluded_packet(scene, &packet);
    else
        triangle_nearest_packet(scene, &packet);
    for (uint lane = 0u; lane < LANES && i + lane < ray_count; lane++) {
        size_t at = i + lane;
        const hit_t hit = packet_hit(&packet, lane);
        hits[3 * at] = packet.met.lane[lane] ? hit.t : rays[7 * at + 6];
        hits[3 * at + 1] = hit.u;
        hits[3 * at + 2] = hit.v;
        primitives[at] = any_hit ? (uint)(packet.met.lane[lane] != 0) : packet.met.lane[lane] ? hit.primitive : 0xffffffffu;
    }
}
"""

NONE = 0xFFFFFFFF


def scene_struct(arrays: dict[str, str]) -> str:
    """``scene_t`` with an encoder's arrays, given by name and C type."""
    fields = "".join(f"    global const {c_type} *triangle_{name};\n" for name, c_type in arrays.items())
    return f"typedef struct {{\n{fields}    uint triangle_count;\n    uint triangle_first;\n}} scene_t;\n"


@cache
def _program(device: cl.Device, layout: str, arrays: tuple[tuple[str, str], ...], defines: str) -> tuple[cl.Context, cl.CommandQueue, cl.Kernel]:
    context = context_of(device)
    kernel = PACKET_KERNEL if layout in PACKET_LAYOUTS else KERNEL
    kernel %= ("".join(f"global const {c_type} *{name}, " for name, c_type in arrays), "".join(f"{name}, " for name, _ in arrays))
    defines += "" if is_gpu(device) else "#define CPU\n"
    layout_text = SHAPE + template(f"accel/{layout}.cl") + kernel
    text = assemble("trace.cl", defines, {"scene/lanes.cl": in_lanes("lib/vector.cl", "lib/ray.cl"), "trace.cl": scene_struct(dict(arrays)) + layout_text})
    return context, cl.CommandQueue(context), cl.Kernel(cl.Program(context, text).build(), "trace")


class Tracer:
    """Triangles (n, 3, 3) float32 behind an accelerator on a device. Primitives come back as indices into what was given, NONE for a miss."""

    def __init__(self, device: cl.Device, triangles: np.ndarray, accelerator: Accelerator, *, topology: Topology | None = None,
                 defines: str = "", first: int = 0) -> None:
        triangles = np.ascontiguousarray(triangles, np.float32)
        self.count, self.first = len(triangles), first
        records = np.zeros(len(triangles), Triangle.record)
        records["vertices"] = triangles
        if topology is None and len(triangles):
            made = accelerator.accelerate(Triangle, records)
            self.order, records, arrays = made.order, made.records, made.arrays
        else:
            topology = topology or accelerator.topology(Triangle, records)
            self.order, records = topology.order, records[topology.order]
            arrays = {**accelerator.encode(topology, records)}
        arrays["vertices"] = records["vertices"]
        defines += "#define SHARED_PRIMITIVES\n" if "references" in arrays else ""
        types = tuple((name, {"f": "float", "u": "uint"}[array.dtype.kind]) for name, array in arrays.items())
        self.context, self.queue, self.kernel = _program(device, accelerator.name, types, defines)
        self.buffers = [self._upload(array) for array in arrays.values()]

    def _upload(self, array: Array) -> cl.Buffer:
        array = np.ascontiguousarray(array) if array.nbytes else np.zeros(16, np.float32)
        return cl.Buffer(self.context, cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR, hostbuf=array)

    def _trace(self, origins: np.ndarray, directions: np.ndarray, t_max: np.ndarray | float, any_hit: bool) -> tuple[np.ndarray, np.ndarray]:
        n = len(directions)
        rays = np.zeros((n, 7), np.float32)
        rays[:, :3], rays[:, 3:6], rays[:, 6] = origins, directions, t_max
        hits, primitives = np.zeros((n, 3), np.float32), np.zeros(n, np.uint32)
        hits_d = cl.Buffer(self.context, cl.mem_flags.WRITE_ONLY, hits.nbytes)
        primitives_d = cl.Buffer(self.context, cl.mem_flags.WRITE_ONLY, primitives.nbytes)
        self.kernel(self.queue, (-(-n // 64) * 64,), (64,), *self.buffers, np.uint32(self.count), np.uint32(self.first), self._upload(rays),
                    np.uint32(n), np.int32(any_hit), hits_d, primitives_d)
        cl.enqueue_copy(self.queue, hits, hits_d)
        cl.enqueue_copy(self.queue, primitives, primitives_d)
        return hits, primitives

    def nearest(self, origins: np.ndarray, directions: np.ndarray, t_max: np.ndarray | float = np.inf) -> tuple[np.ndarray, np.ndarray]:
        """Hits (n, 3) float32: t, u, v; and primitives (n,) uint32."""
        hits, primitives = self._trace(origins, directions, t_max, False)
        assert not np.any(primitives == NONE - 1), "what was returned and what was stored disagree"
        met = primitives != NONE
        primitives[met] = self.order[primitives[met] - self.first]
        return hits, primitives

    def occluded(self, origins: np.ndarray, directions: np.ndarray, t_max: np.ndarray | float = np.inf) -> np.ndarray:
        """(n,) bool."""
        return self._trace(origins, directions, t_max, True)[1] == 1
