"""Materials of mesh files, in glTF's metallic-roughness terms → materials of ours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from lumiere.bsdf import Material
from lumiere.bsdf.conductor import Conductor
from lumiere.bsdf.plastic import Plastic
from lumiere.imagefile import read_image
from lumiere.meshfile import FileMaterial
from lumiere.texture.image import ImageTexture


def _image(picture: Any, encoding: str, **keys: Any) -> ImageTexture:
    source = {"file": picture} if isinstance(picture, (str, Path)) else {"pixels": picture}
    return ImageTexture(encoding=encoding, **source, **keys)


def _opacity(material: FileMaterial) -> Any:
    """A constant or the base colour picture's alpha; where the mode is ``mask``, cut off to 0 and 1."""
    if material.alpha_mode == "opaque":
        return 1.0
    picture = material.base_color_image
    pixels = read_image(picture) if isinstance(picture, (str, Path)) else picture
    if pixels is None or pixels.shape[2] not in (2, 4):
        return float(material.opacity >= material.alpha_cutoff) if material.alpha_mode == "mask" else material.opacity
    if material.alpha_mode == "blend":
        return _image(picture, "srgb", channel="a", factor=(material.opacity,) * 3)
    alpha = pixels[..., -1:].astype(np.float32) / (255.0 if pixels.dtype == np.uint8 else 1.0)
    return ImageTexture(pixels=(alpha * material.opacity >= material.alpha_cutoff).astype(np.float32), encoding="linear")


def material_of(material: FileMaterial) -> Material:
    """Plastic, or a conductor where the file says metal throughout: a material that is partly metal is shaded as plastic."""
    common: dict[str, Any] = {"name": material.name, "two_sided": True, "opacity": _opacity(material)}
    if material.emission_image is not None:
        common["emission"] = _image(material.emission_image, "srgb", factor=material.emission)
    elif any(material.emission):
        common["emission"] = material.emission
    if material.normal_image is not None:
        common["normal_map"] = _image(material.normal_image, "linear")
    packed = material.metallic_roughness_image
    roughness = material.roughness if packed is None else _image(packed, "linear", channel="g", factor=(material.roughness,) * 3)
    if packed is None and material.base_color_image is None and material.metallic > 0.5:
        # The real index that reflects the base colour at normal incidence.
        root = np.sqrt(np.clip(material.base_color, 0.0, 0.99))
        return Conductor(eta=tuple((1.0 + root) / (1.0 - root)), k=(0.0, 0.0, 0.0), roughness=roughness, **common)
    color = material.base_color
    if material.base_color_image is not None:
        return Plastic(albedo=_image(material.base_color_image, "srgb", factor=color), roughness=roughness, **common)
    return Plastic(albedo=color, roughness=roughness, **common)
