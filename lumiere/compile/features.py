"""Features: what a scene makes the renderer compile, allocate and launch. Nothing else is."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from lumiere.accel import PACKET_LAYOUTS

AOV_CHANNELS = {"albedo": 3, "normal": 3, "position": 3, "depth": 1, "uv": 2, "direct": 3, "indirect": 3, "emission": 3,
                "material_id": 1, "object_id": 1}
"""Channels of the AOVs that the device writes. Those of ids come last: they are not averaged."""

ID_AOVS = ("material_id", "object_id")
FIRST_HIT_AOVS = ("albedo", "normal", "position", "depth", "uv", "material_id", "object_id")


@dataclass(frozen=True)
class Features:
    """What the kernels are built for. Two scenes with equal features share every program."""

    shapes: dict[str, str]
    """Device shape → layout of its accelerator."""
    bsdfs: dict[str, tuple[str, ...]]
    """BSDF kind → its parameters that some material of the scene textures."""
    camera: str
    sampler: str
    bsdf_features: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """BSDF kind → macros with which it is compiled."""
    shared_primitives: tuple[str, ...] = ()
    """Device shapes of whose primitives some are in several leaves."""
    lights: tuple[str, ...] = ()
    """Kinds of lights that are not shapes."""
    infinite_lights: tuple[str, ...] = ()
    textures: tuple[str, ...] = ()
    emission: bool = False
    emitters: bool = False
    textured_emission: bool = False
    next_event_estimation: bool = False
    light_sampling: str = "mis"
    bsdf_pdf: bool = False
    eta_scale: bool = False
    camera_lens: bool = False
    camera_partial: bool = False
    filter_table: bool = False
    clamp_indirect: bool = False
    visibility: bool = False
    opacity: bool = False
    textured_opacity: bool = False
    normal_map: bool = False
    bump_map: bool = False
    ray_cones: bool = False
    """Paths know how wide a patch of surface they stand for: some texture is filtered over it."""
    nested: bool = False
    """Bodies overlap, and the one of the highest priority counts."""
    subsurface: bool = False
    """Some body scatters inside."""
    mixes: bool = False
    textured_mixes: bool = False
    triangle_corners: bool = False
    vertex_normals: bool = False
    vertex_uvs: bool = False
    vertex_colors: bool = False
    surface_uv: bool = False
    surface_tangent: bool = False
    surface_color: bool = False
    pixel_list: bool = False
    """Batches name their pixels one by one."""
    traced: bool = False
    """A path is being replayed, and keeps the densities that were weighed against each other (lumiere/trace)."""
    aovs: tuple[str, ...] = ()
    specular_bsdfs: tuple[str, ...] = field(default=())
    """BSDF kinds that have Dirac lobes only, and so no light sampling."""

    @property
    def ray_packets(self) -> bool:
        """Sixteen neighbouring slots' rays are traced together."""
        return any(layout in PACKET_LAYOUTS for layout in self.shapes.values())

    def channels(self) -> dict[str, int]:
        """First channel of each output in the sample buffer; radiance is the first."""
        channels, count = {"radiance": 0}, 3
        for name, size in AOV_CHANNELS.items():
            if name in self.aovs:
                channels[name] = count
                count += size
        return channels

    def channel_count(self) -> int:
        """Channels of the sample buffer."""
        return 3 + sum(size for name, size in AOV_CHANNELS.items() if name in self.aovs)

    def as_record(self) -> dict[str, Any]:
        """Those that are set, for the record."""
        return {name: value for name, value in asdict(self).items() if value}
