"""What of the principled material a scene compiles, and what it refuses."""

from __future__ import annotations

import pytest

import lumiere
from lumiere.compile.scene import compile_scene


def scene(*materials: dict[str, object], **integrator: object) -> dict[str, object]:
    spheres = [{"type": "sphere", "position": [3 * i, 0, 0], "radius": 1, "material": m} for i, m in enumerate(materials)]
    return {"scene": {"geometry": spheres, "integrator": integrator}}


def features(*materials: dict[str, object], **integrator: object) -> dict[str, tuple[str, ...]]:
    return compile_scene(lumiere.load(scene(*materials, **integrator))).features.bsdf_features


def test_lobes_are_compiled_where_a_material_has_them() -> None:
    assert features({"type": "principled"})["principled"] == ("ENERGY_COMPENSATION",)
    assert "PRINCIPLED_COAT" in features({"type": "principled", "clearcoat": 0.1})["principled"]
    assert "PRINCIPLED_SHEEN" in features({"type": "principled", "sheen": [0, 0, 0.1]})["principled"]
    assert "PRINCIPLED_GLASS" in features({"type": "principled", "transmission": {"type": "checker"}})["principled"]
    both = features({"type": "principled", "clearcoat": 1}, {"type": "principled", "sheen": 1})["principled"]
    assert {"PRINCIPLED_COAT", "PRINCIPLED_SHEEN"} <= set(both)


def test_another_value_is_no_other_program() -> None:
    assert features({"type": "principled", "clearcoat": 0.2}) == features({"type": "principled", "clearcoat": 0.3})


def test_compensation_is_the_scenes_choice() -> None:
    for kind, shades in (("conductor", "rough_conductor"), ("dielectric", "rough_dielectric"), ("plastic", "plastic")):
        rough = {"type": kind, "roughness": 0.5}
        assert features(rough)[shades] == features(rough, energy_compensation=True)[shades] == ("ENERGY_COMPENSATION",)
        assert features(rough, energy_compensation=False)[shades] == ()
        assert features({"type": kind, "roughness": 0})[kind] == ()


@pytest.mark.parametrize("value", [0.5, {"type": "constant", "value": 0.5}])
def test_only_a_body_that_scatters_walks(value: object) -> None:
    assert "WALKS" in features({"type": "principled", "subsurface": value})["principled"]
    assert "WALKS" not in features({"type": "principled", "subsurface": 0, "subsurface_radius": [1, 0.2, 0.1]})["principled"]
