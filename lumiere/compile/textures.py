"""Textures → records and texels."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lumiere.texture import Texture
from lumiere.texture.pyramid import pyramid

FORMAT_SRGB8, FORMAT_LINEAR8, FORMAT_FLOAT = range(3)


def srgb_decode(x: np.ndarray) -> np.ndarray:
    """Linear value of an sRGB-encoded one in [0, 1] (IEC 61966-2-1:1999)."""
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


SRGB_VALUES = srgb_decode(np.arange(256, dtype=np.float64) / 255.0).astype(np.float32)
"""Linear values of sRGB's bytes."""


def srgb_encode(x: np.ndarray) -> np.ndarray:
    """The inverse of ``srgb_decode``."""
    return np.where(x <= 0.0031308, x * 12.92, 1.055 * x ** (1.0 / 2.4) - 0.055)


def linear_rgb(pixels: np.ndarray, encoding: str | None) -> np.ndarray:
    """(h, w, 3) float32 linear Rec. 709 from (h, w, c) uint8 or float32 as read from a file; grey is repeated, alpha dropped."""
    rgb = pixels[..., :3] if pixels.shape[2] >= 3 else np.repeat(pixels[..., :1], 3, axis=2)
    if pixels.dtype == np.uint8:
        return ((np.arange(256) / 255.0).astype(np.float32) if encoding == "linear" else SRGB_VALUES)[rgb]
    return srgb_decode(rgb).astype(np.float32) if encoding == "srgb" else rgb.astype(np.float32)


def _smaller(rgba: np.ndarray, texel_format: int) -> list[np.ndarray]:
    """The words of a picture's smaller levels; ``rgba`` is (h, w, 4) as stored."""
    if texel_format == FORMAT_FLOAT:
        return [level.astype(np.float32).view(np.uint32) for level in pyramid(rgba.astype(np.float32))[1:]]
    values = rgba.astype(np.float32) / 255.0
    if texel_format == FORMAT_SRGB8:
        values[..., :3] = srgb_decode(values[..., :3])
    levels = pyramid(values)[1:]
    if texel_format == FORMAT_SRGB8:
        levels = [np.concatenate([srgb_encode(level[..., :3]), level[..., 3:]], axis=2) for level in levels]
    return [np.ascontiguousarray(np.rint(level * 255.0).astype(np.uint8)).view(np.uint32) for level in levels]


@dataclass
class TexelStore:
    """All pictures of a scene in one array of 32-bit words: 8-bit RGBA takes one word a texel, float RGBA four. A picture is stored once
    for each filter that needs it as it is, or with its pyramid behind it."""

    words: list[np.ndarray] = field(default_factory=list)
    size: int = 0
    _known: dict[tuple[Any, Any, bool], tuple[int, int]] = field(default_factory=dict)

    def add(self, texture: Any, pixels: np.ndarray) -> tuple[int, int]:
        """Stores ``pixels`` (h, w, c) unless it is there; returns the number of its first word and its format."""
        key = (str(texture.file) if texture.file else id(pixels), texture.encoding, texture.filter == "mipmap")
        if key in self._known:
            return self._known[key]
        height, width, channels = pixels.shape
        opaque = 255 if pixels.dtype == np.uint8 else 1.0
        rgba = np.full((height, width, 4), opaque, dtype=pixels.dtype)
        rgba[..., :3] = pixels[..., :3] if channels >= 3 else pixels[..., :1]
        if channels in (2, 4):
            rgba[..., 3] = pixels[..., channels - 1]
        rgba = np.ascontiguousarray(rgba[::-1])  # row 0 at the bottom, where v is 0
        if pixels.dtype == np.uint8:
            words = rgba.view(np.uint32)
            texel_format = FORMAT_LINEAR8 if texture.encoding == "linear" else FORMAT_SRGB8
        else:
            if texture.encoding == "srgb":
                rgba[..., :3] = srgb_decode(rgba[..., :3])
            words = rgba.astype(np.float32).view(np.uint32)
            texel_format = FORMAT_FLOAT
        self._known[key] = (self.size, texel_format)
        for level in [words, *(_smaller(rgba, texel_format) if texture.filter == "mipmap" else [])]:
            self.words.append(level.ravel())
            self.size += level.size
        return self._known[key]


@dataclass
class TextureTable:
    """The textures that a scene's materials use, by kind. A texture's device id is its kind's number << 24 | its index."""

    kinds: list[str] = field(default_factory=list)
    records: dict[str, list[np.ndarray]] = field(default_factory=dict)
    texels: TexelStore = field(default_factory=TexelStore)
    uses: set[str] = field(default_factory=set)
    _ids: dict[int, int] = field(default_factory=dict)
    _kept: list[Texture] = field(default_factory=list)

    def id(self, texture: Texture) -> int:
        """Device id of ``texture``, which is added where it is new."""
        known = self._ids.get(id(texture))
        if known is not None:
            return known
        kind = texture.type
        if kind not in self.kinds:
            self.kinds.append(kind)
            self.records[kind] = []
        records = self.records[kind]
        record = np.zeros((), dtype=texture.record)
        for name, value in texture.device_record(self.texels).items():
            record[name] = value
        number = self.kinds.index(kind) << 24 | len(records)
        records.append(record)
        self.uses.update(texture.uses)
        self._ids[id(texture)] = number
        self._kept.append(texture)  # so that its id() stays its own
        return number
