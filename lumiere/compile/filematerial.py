"""Materials of mesh files, in the terms of glTF's metallic-roughness model and its extensions → materials of ours."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from lumiere.bsdf import Material
from lumiere.bsdf.lambert import Lambert
from lumiere.bsdf.mix import Mix
from lumiere.bsdf.principled import Principled
from lumiere.bsdf.thin_dielectric import ThinDielectric
from lumiere.imagefile import read_image
from lumiere.meshfile import FileMaterial
from lumiere.texture import Texture
from lumiere.texture.image import ImageTexture

BLACK = (0.0, 0.0, 0.0)


def _image(picture: Any, encoding: str, **keys: Any) -> ImageTexture:
    source = {"file": picture} if isinstance(picture, (str, Path)) else {"pixels": picture}
    return ImageTexture(encoding=encoding, **source, **keys)


def _pixels(picture: Any) -> np.ndarray:
    """(h, w, c) float32 in [0, 1] as stored, row 0 at the top."""
    pixels = read_image(picture) if isinstance(picture, (str, Path)) else picture
    return pixels.astype(np.float32) / (255.0 if pixels.dtype == np.uint8 else 1.0)


def _number(factor: float, picture: Any, channel: str) -> float | Texture:
    """A number, or the picture's channel times it."""
    return factor if picture is None or factor == 0.0 else _image(picture, "linear", channel=channel, factor=(factor,) * 3)


def _color(factor: tuple[float, float, float], picture: Any) -> tuple[float, float, float] | Texture:
    return factor if picture is None or not any(factor) else _image(picture, "srgb", factor=factor)


def _opacity(material: FileMaterial) -> float | Texture:
    """A constant or the base colour picture's alpha; where the mode is ``mask``, cut off to 0 and 1."""
    if material.alpha_mode == "opaque":
        return 1.0
    pixels = None if material.base_color_image is None else _pixels(material.base_color_image)
    if pixels is None or pixels.shape[2] not in (2, 4):
        return float(material.opacity >= material.alpha_cutoff) if material.alpha_mode == "mask" else material.opacity
    if material.alpha_mode == "blend":
        return _image(material.base_color_image, "srgb", channel="a", factor=(material.opacity,) * 3)
    return ImageTexture(pixels=(pixels[..., -1:] * material.opacity >= material.alpha_cutoff).astype(np.float32), encoding="linear")


def _normal_map(material: FileMaterial) -> Texture:
    """The picture, its x and y scaled."""
    if material.normal_scale == 1.0:
        return _image(material.normal_image, "linear")
    normals = (2.0 * _pixels(material.normal_image)[..., :3] - 1.0) * (material.normal_scale, material.normal_scale, 1.0)
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = normals / np.where(lengths > 0.0, lengths, 1.0)
    return ImageTexture(pixels=(0.5 * normals + 0.5).astype(np.float32), encoding="linear")


def material_of(material: FileMaterial) -> Material:
    """``principled``, seen from both sides unless light crosses it; a film without volume is a ``mix`` with ``thin_dielectric``, whose roughness
    is lost; what is unlit emits its colour. Not kept: the direction of anisotropy, and what occludes ambient light, which is computed here.
    """
    common: dict[str, Any] = {"name": material.name, "opacity": _opacity(material)}
    base_color = _color(material.base_color, material.base_color_image)
    if material.unlit:
        return Lambert(albedo=BLACK, emission=base_color, emission_sides="both", **common)
    if any(material.emission):
        common["emission"] = _color(material.emission, material.emission_image)
    if material.normal_image is not None:
        common["normal_map"] = _normal_map(material)
    transmission = _number(material.transmission, material.transmission_image, "r")
    if material.thin and material.transmission > 0.0:
        film = ThinDielectric(ior=max(1.0, material.ior), transmittance=base_color)
        opaque = material_of(replace(material, transmission=0.0, emission=BLACK, normal_image=None, alpha_mode="opaque"))
        return Mix(a=opaque, b=film, weight=transmission, **common)
    packed = material.metallic_roughness_image
    specular = 0.5 * material.specular
    return Principled(
        base_color=base_color, metallic=_number(material.metallic, packed, "b"), roughness=_number(material.roughness, packed, "g"),
        ior=max(1.0, material.ior), specular=_number(specular, material.specular_image, "a"),
        specular_tint=_color(material.specular_color, material.specular_color_image),
        clearcoat=_number(material.clearcoat, material.clearcoat_image, "r"),
        clearcoat_roughness=_number(material.clearcoat_roughness, material.clearcoat_roughness_image, "g"),
        sheen=_color(material.sheen_color, material.sheen_color_image),
        sheen_roughness=_number(material.sheen_roughness, material.sheen_roughness_image, "a"), anisotropy=material.anisotropy,
        transmission=transmission,
        two_sided=material.transmission == 0.0, **common)
