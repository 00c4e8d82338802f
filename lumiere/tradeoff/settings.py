"""Everything that trades speed for accuracy, as changes to a scene's own settings."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from lumiere.accel import Accelerator, choose, layouts, preferring
from lumiere.accel.spatial import with_spatial_splits
from lumiere.overrides import Overrides
from lumiere.scene.model import Scene
from lumiere.texture.image import FILTERS, ImageTexture

OWN = "own settings"

MATHS = {"mad": "-cl-mad-enable", "relaxed": "-cl-fast-relaxed-math"}

MATHS_STAGES = ("extend", "shade", "connect")
"""Where the time goes; each gets other maths by itself, beside all stages together."""


@dataclass(frozen=True)
class Setting:
    """One change: ``factor`` is what is changed, ``value`` what to. ``builds``: other programs than the scene's own are needed."""

    factor: str
    value: str
    change: Callable[[Scene], Scene] = lambda scene: scene
    overrides: Overrides = Overrides()
    builds: bool = False
    unbiased: bool = True
    """No bias is expected of it beyond that of the scene's own settings."""

    @property
    def name(self) -> str:
        """For tables."""
        return self.factor if not self.value else f"{self.factor} {self.value}"


def own() -> Setting:
    """The scene as it is."""
    return Setting(OWN, "")


def with_spp(scene: Scene, spp: int) -> Scene:
    """The scene with ``spp`` samples a pixel."""
    return replace(scene, sampler=replace(scene.sampler, spp=spp))


def _integrator(**keys: Any) -> Callable[[Scene], Scene]:
    return lambda scene: replace(scene, integrator=replace(scene.integrator, **keys))


def settings(scene: Scene, mean_radiance: float) -> Iterator[Setting]:
    """The changes that make sense for ``scene``, the most telling first. ``mean_radiance`` is the picture's, to scale ``clamp_indirect``."""
    integrator = scene.integrator
    for stages in ((), *((stage,) for stage in MATHS_STAGES)):
        for name, option in MATHS.items():
            value = f"{name} in {stages[0]}" if stages else name
            yield Setting("maths", value, overrides=Overrides(compiler_options=(option,), stages=stages), builds=True)
    if integrator.type == "path":
        for depth in (2, 4, 8, 32, 64):
            if depth != integrator.max_depth:
                yield Setting("max_depth", str(depth), _integrator(max_depth=depth), unbiased=depth > integrator.max_depth)
        for depth in (None, 2, 3, 8):
            if depth != integrator.russian_roulette_depth and (depth is None or depth < integrator.max_depth):
                yield Setting("russian_roulette_depth", "never" if depth is None else str(depth), _integrator(russian_roulette_depth=depth))
    yield from _texture_filters(scene)
    if _compensates(scene):
        value = not integrator.energy_compensation
        yield Setting("energy_compensation", "on" if value else "off", _integrator(energy_compensation=value), builds=True, unbiased=False)
    for mode in ("light", "bsdf", "mis"):
        if mode != integrator.light_sampling:
            yield Setting("light_sampling", mode, _integrator(light_sampling=mode), builds=True)
    for kind in ("independent", "stratified", "sobol"):
        if kind != scene.sampler.type:
            yield Setting("sampler", kind, lambda scene, kind=kind: replace(scene, sampler=replace(scene.sampler, type=kind)), builds=True)
    for value in (None, 1.0 * mean_radiance, 10.0 * mean_radiance):
        if value != integrator.clamp_indirect and value != 0.0:
            text = "off" if value is None else f"{value:.3g}"
            yield Setting("clamp_indirect", text, _integrator(clamp_indirect=value), builds=True, unbiased=False)
    yield from _accelerators()


def _accelerators() -> Iterator[Setting]:
    """Each layout for whatever it can hold; and the scene's own layout over topologies of other qualities: one that the builder did not optimise, and one
    with spatial splits."""
    for name in layouts():
        if name != "flat":
            yield Setting("accelerator", name, overrides=Overrides(accelerator=preferring(name)), builds=True)
    yield Setting("accelerator", "of low build quality", overrides=Overrides(accelerator=_low_quality))
    yield Setting("accelerator", "with spatial splits", overrides=Overrides(accelerator=with_spatial_splits(choose)), builds=True)


class _HighTraversalCost(Accelerator):
    """An accelerator whose builder is told that a step of traversal is dear, so that it makes the fullest leaves that its layout takes."""

    def __init__(self, accelerator: Accelerator, max_leaf_size: int) -> None:
        self.accelerator, self.name, self.max_leaf_size = accelerator, accelerator.name, max_leaf_size  # type: ignore[misc]

    def build(self, lower: Any, upper: Any) -> Any:
        from lumiere.accel.build import build

        return build(lower, upper, max_leaf_size=self.max_leaf_size, traversal_cost=1e6)

    def encode(self, topology: Any, records: Any) -> Any:
        return self.accelerator.encode(topology, records)


def _low_quality(shape: str, n_primitives: int, bounded: bool, wide: bool) -> Accelerator:
    accelerator = choose(shape, n_primitives, bounded, wide)
    return accelerator if accelerator.name == "flat" else _HighTraversalCost(accelerator, 8)


def _texture_filters(scene: Scene) -> Iterator[Setting]:
    pictures = [texture for texture in _textures(scene) if isinstance(texture, ImageTexture)]
    used = {texture.filter for texture in pictures}
    for name in FILTERS:
        if pictures and used != {name}:
            yield Setting("texture filter", name, lambda scene, name=name: _with_filter(scene, name), unbiased=False)


def _compensates(scene: Scene) -> bool:
    """Does some material look otherwise with the integrator's ``energy_compensation``?"""
    materials = [*scene.materials.values(), *(shape.material for shape in scene.geometry if shape.material)]
    return any(material.compensates for material in materials)


def _textures(scene: Scene) -> list[Any]:
    """Textures of the scene, those written in place included."""
    found, places = list(scene.textures.values()), [*scene.materials.values(), *(s.material for s in scene.geometry if s.material)]
    for thing in [*places, *scene.geometry]:
        found += [value for value in vars(thing).values() if isinstance(value, ImageTexture)]
    return found


def _with_filter(scene: Scene, name: str) -> Scene:
    import copy

    changed = copy.deepcopy(scene)
    for texture in _textures(changed):
        if isinstance(texture, ImageTexture):
            texture.filter = name
    return changed


def strictest(scene: Scene) -> Scene:
    """The scene as the reference renders it: no clamping, paths four times as long, light found in both ways."""
    integrator = scene.integrator
    changed = replace(integrator, clamp_indirect=None, light_sampling="mis", max_depth=min(65535, max(64, 4 * integrator.max_depth)))
    return replace(scene, integrator=changed if integrator.type == "path" else replace(integrator, clamp_indirect=None, light_sampling="mis"),
                   sampler=replace(scene.sampler, type="sobol"))
