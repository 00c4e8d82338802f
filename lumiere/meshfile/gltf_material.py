"""Materials and pictures of glTF files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lumiere.meshfile.part import FileMaterial, MeshFileError, Picture
from lumiere.meshfile.picture import decode

if TYPE_CHECKING:
    from lumiere.meshfile.gltf import Document


@dataclass(frozen=True)
class Mapping:
    """Which of a primitive's uv sets a material's pictures use, and how it is transformed (KHR_texture_transform)."""

    uv_set: int = 0
    offset: tuple[float, ...] = (0.0, 0.0)
    rotation: float = 0.0
    scale: tuple[float, ...] = (1.0, 1.0)

    def apply(self, uvs: np.ndarray) -> np.ndarray:
        """uvs (n, 2), scaled, rotated and moved, v running down."""
        c, s = np.cos(self.rotation), np.sin(self.rotation)
        return (uvs * self.scale) @ np.array([[c, -s], [s, c]]) + self.offset


NUMBERS = (
    ("ior", "KHR_materials_ior", "ior"),
    ("specular", "KHR_materials_specular", "specularFactor"),
    ("clearcoat", "KHR_materials_clearcoat", "clearcoatFactor"),
    ("clearcoat_roughness", "KHR_materials_clearcoat", "clearcoatRoughnessFactor"),
    ("sheen_roughness", "KHR_materials_sheen", "sheenRoughnessFactor"),
    ("transmission", "KHR_materials_transmission", "transmissionFactor"),
    ("anisotropy", "KHR_materials_anisotropy", "anisotropyStrength"),
)
"""What FileMaterial has of the extensions: its attribute, the extension, the extension's key."""
COLORS = (
    ("specular_color", "KHR_materials_specular", "specularColorFactor"),
    ("sheen_color", "KHR_materials_sheen", "sheenColorFactor"),
)
PICTURES = tuple((f"{name}_image", extension, key.replace("Factor", "Texture"))
                 for name, extension, key in (*NUMBERS[1:6], *COLORS))


class Materials:
    """The materials of a file, each made once and with its pictures read only where it is used."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self._materials: dict[int, tuple[FileMaterial, Mapping]] = {}
        self._pictures: dict[int, Picture] = {}

    def of(self, index: Any) -> tuple[FileMaterial | None, Mapping | None]:
        """The material of a primitive that names ``index``, or None."""
        if index is None:
            return None, None
        entry = self.document.item("materials", index)
        if index not in self._materials:
            self._materials[index] = self._read(entry)
        return self._materials[index]

    def _read(self, entry: dict[str, Any]) -> tuple[FileMaterial, Mapping]:
        pbr = entry.get("pbrMetallicRoughness", {})
        name = str(entry.get("name", ""))
        infos = [pbr.get("baseColorTexture"), pbr.get("metallicRoughnessTexture"), entry.get("normalTexture"), entry.get("emissiveTexture")]
        extensions = {str(key): value for key, value in entry.get("extensions", {}).items() if isinstance(value, dict)}
        of_extensions = [extensions.get(extension, {}).get(key) for _, extension, key in PICTURES]
        mappings = {_mapping(info) for info in [*infos, *of_extensions] if info is not None}
        if len(mappings) > 1:
            raise MeshFileError(f"found pictures of material {name!r} on different uv sets or transforms, expected one for all of them")
        base_color, base_alpha = _floats(pbr.get("baseColorFactor", [1, 1, 1, 1]), 4)[:3], pbr.get("baseColorFactor", [1, 1, 1, 1])[3]
        strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
        material = FileMaterial(
            name=name, base_color=base_color, base_color_image=self._picture(infos[0]),
            metallic=float(pbr.get("metallicFactor", 1.0)), roughness=float(pbr.get("roughnessFactor", 1.0)),
            metallic_roughness_image=self._picture(infos[1]), normal_image=self._picture(infos[2]),
            emission=_floats([strength * e for e in entry.get("emissiveFactor", [0, 0, 0])], 3), emission_image=self._picture(infos[3]),
            opacity=float(base_alpha), alpha_mode=str(entry.get("alphaMode", "OPAQUE")).lower(),
            alpha_cutoff=float(entry.get("alphaCutoff", 0.5)), double_sided=bool(entry.get("doubleSided", False)),
            normal_scale=float((infos[2] or {}).get("scale", 1.0)), unlit="KHR_materials_unlit" in extensions,
            thin=not extensions.get("KHR_materials_volume", {}).get("thicknessFactor", 0.0))
        for name, extension, key in NUMBERS:
            if key in extensions.get(extension, {}):
                setattr(material, name, _number(extensions[extension][key], key))
        for name, extension, key in COLORS:
            if key in extensions.get(extension, {}):
                setattr(material, name, _floats(extensions[extension][key], 3))
        for (name, _, _), info in zip(PICTURES, of_extensions, strict=True):
            setattr(material, name, self._picture(info))
        if material.alpha_mode not in ("opaque", "blend", "mask"):
            raise MeshFileError(f"found alphaMode {entry['alphaMode']!r}, expected OPAQUE, BLEND or MASK")
        return material, mappings.pop() if mappings else Mapping()

    def _picture(self, info: dict[str, Any] | None) -> Picture | None:
        if info is None:
            return None
        texture = self.document.item("textures", info["index"])
        source = texture.get("source", texture.get("extensions", {}).get("EXT_texture_webp", {}).get("source"))
        image = self.document.item("images", source)
        if source not in self._pictures:
            what = f"picture {image.get('name', source)!r}"
            data = self.document.resource(image["uri"], what) if "uri" in image else bytes(self.document.view(image["bufferView"])[0])
            self._pictures[source] = data if isinstance(data, Path) else decode(data, what)
        return self._pictures[source]


def _number(value: Any, what: str) -> float:
    number = float(value)
    if not np.isfinite(number):
        raise MeshFileError(f"found {value} for {what}, expected a finite number")
    return number


def _floats(values: Any, count: int) -> tuple[float, ...]:
    floats = tuple(float(v) for v in values)
    if len(floats) != count or not np.isfinite(floats).all():
        raise MeshFileError(f"found {values}, expected {count} numbers")
    return floats


def _mapping(info: dict[str, Any]) -> Mapping:
    transform = info.get("extensions", {}).get("KHR_texture_transform", {})
    return Mapping(uv_set=transform.get("texCoord", info.get("texCoord", 0)), offset=_floats(transform.get("offset", [0, 0]), 2),
                   rotation=float(transform.get("rotation", 0.0)), scale=_floats(transform.get("scale", [1, 1]), 2))
