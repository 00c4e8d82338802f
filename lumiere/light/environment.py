"""The environment."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from lumiere.light import LIGHTS, Light, luminance
from lumiere.light.distribution import distribution_2d
from lumiere.scene.fields import Spectrum, file, spectrum, transform


@LIGHTS.register
@dataclass(kw_only=True)
class EnvironmentLight(Light):
    """Light from all around: a constant, or a lat-long picture whose centre column is −Z, columns running to the viewer's right, +Y up.

    A picture is looked up bilinearly and sampled by the integral of that over each texel and sin θ (PBR 4ed, §12.5).
    """

    type: ClassVar[str] = "environment"
    record: ClassVar[np.dtype] = np.dtype([
        ("radiance", "<f4", 3), ("to_local", "<f4", (3, 3)), ("width", "<i4"), ("height", "<i4")])

    radiance: Spectrum = spectrum(1.0, doc="W m⁻² sr⁻¹; a factor where there is a file")
    file: Any = file(None, nullable=True, doc="lat-long picture, HDR or EXR")
    transform: Any = transform(doc="its rotation")
    pixels: np.ndarray | None = field(default=None, repr=False, compare=False)

    def check(self) -> str | None:
        """What is wrong with the transform, or None."""
        if self.transform is not None:
            linear = np.asarray(self.transform)[:3, :3]
            if not np.allclose(linear.T @ linear, np.eye(3), atol=1e-5):
                return "found a transform that scales or shears, expected rotations"
        return None

    @property
    def device_kind(self) -> str:
        return "environment" if self.file is None else "environment_image"

    @property
    def infinite(self) -> bool:
        return True

    def image(self) -> np.ndarray:
        """(h, w, 3) float32 linear radiance of the file, row 0 at the top (+Y)."""
        if self.pixels is None:
            from lumiere.compile.textures import linear_rgb
            from lumiere.imagefile import read_image

            self.pixels = np.maximum(linear_rgb(read_image(self.file), None), 0.0)
        return self.pixels

    def device_record(self) -> dict[str, Any]:
        rotation = np.eye(3) if self.transform is None else np.asarray(self.transform)[:3, :3]
        height, width = (0, 0) if self.file is None else self.image().shape[:2]
        return {"radiance": self.radiance, "to_local": rotation.T, "width": width, "height": height}

    def arrays(self) -> dict[str, np.ndarray]:
        if self.file is None:
            return {}
        image = self.image()
        rows, columns = distribution_2d(self._texel_weights())
        return {"environment_texels": image.ravel(), "environment_rows": rows, "environment_columns": columns}

    def _texel_weights(self) -> np.ndarray:
        """(h, w) float64: mean luminance of the bilinear lookup over each texel, times its solid angle's sin θ."""
        y = self.image().astype(np.float64) @ (0.2126, 0.7152, 0.0722)
        y = (np.roll(y, 1, axis=1) + 6.0 * y + np.roll(y, -1, axis=1)) / 8.0
        padded = np.concatenate([y[:1], y, y[-1:]])
        y = (padded[:-2] + 6.0 * padded[1:-1] + padded[2:]) / 8.0
        edges = np.cos(np.linspace(0.0, np.pi, len(y) + 1))
        return y * (edges[:-1] - edges[1:])[:, None]

    def flux(self, scene_radius: float) -> float:
        mean = 1.0
        if self.file is not None:
            weights = self._texel_weights()
            mean = float(weights.sum()) / (2.0 * weights.shape[1])
        return 4.0 * math.pi**2 * scene_radius**2 * luminance(self.radiance) * mean
