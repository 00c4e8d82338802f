"""Whatever the document, loading gives a scene or one line of complaint."""

from __future__ import annotations

import copy
import json
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lumiere.errors import SceneError
from lumiere.scene.load import load
from lumiere.scene.model import Scene

STEPS = [{"scale": [1, 2, 1]}, {"rotate": {"axis": [0, 1, 0], "angle": 30}}, {"translate": [0, 1, 0]},
         {"look_at": {"origin": [0, 0, 0], "target": [1, 0, 0], "up": [0, 1, 0]}}, {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]
VALID = {"scene": {
    "camera": {"type": "thin_lens", "position": [0, 1, 5], "look_at": [0, 0, 0], "up": [0, 1, 0], "fov": 40, "fov_axis": "x",
               "aperture_radius": 0.1, "focus_distance": 5, "blades": 6},
    "film": {"width": 64, "height": 48, "crop": [0, 0, 10, 10], "filter": {"type": "gaussian", "radius": 2}, "aovs": ["depth"], "exposure": 1},
    "integrator": {"type": "path", "max_depth": 4, "russian_roulette_depth": None, "light_sampling": "mis", "clamp_indirect": 2},
    "sampler": {"type": "sobol", "spp": 4, "seed": 1, "adaptive": None},
    "textures": {"t": {"type": "checker", "a": 0.1, "b": [0.2, 0.3, 0.4], "scale": [2, 3]}, "c": {"type": "constant", "value": "#808080"}},
    "materials": {"m": {"type": "lambert", "albedo": {"texture": "t"}, "emission": [1, 2, 3], "two_sided": True, "bump_map": {"texture": "c"}},
                  "n": {"type": "mirror", "reflectance": {"type": "constant", "value": 0.5}}},
    "media": {},
    "geometry": [{"type": "sphere", "position": [0, 0, 0], "radius": 1, "material": "m", "name": "ball", "visible": {"camera": True}},
                 {"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "material": {"type": "lambert"}, "transform": STEPS},
                 {"type": "disk", "normal": [0, 1, 0], "radius": 2, "emission": 3},
                 {"type": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [0, 1, 2], "uvs": [0, 0, 1, 0, 0, 1], "smooth": False}],
    "lights": [{"type": "point", "position": [0, 5, 0], "intensity": 3}, {"type": "directional", "direction": [0, -1, 0]},
               {"type": "area", "radius": 1, "power": 5}, {"type": "spot", "cone": 20}, {"type": "environment", "radiance": 0.5}]}}

WORDS = st.sampled_from(["", "type", "scene", "t", "m", "lambert", "mirror", "sphere", "mesh", "texture", "transform", "position", "none", "..",
                         "#ff0000", "\0", "a\nb", "\u2028", "é"])
NUMBERS = st.sampled_from([0, -0.0, 1, -1, 0.5, 2, 1e-300, 5e-324, 1e38, -3.4e38, 1e39, 1e308, 2**31, 2**32, 2**63, 2**64, 10**400]) | st.floats()
SCALARS = st.none() | st.booleans() | NUMBERS | WORDS | st.text(max_size=8)
JSON = st.recursive(SCALARS, lambda children: st.lists(children, max_size=4) | st.dictionaries(WORDS | st.text(max_size=4), children, max_size=4),
                    max_leaves=12)


def loads_or_complains(document: object, folder: Path) -> None:
    """Both as a dict and as a file."""
    file = folder / "s.json"
    file.write_text(json.dumps(document))
    for source in (document, file):
        try:
            assert isinstance(load(source), Scene)  # type: ignore[arg-type]
        except SceneError as error:
            text = str(error)
            assert len(text.splitlines()) == 1
            assert len(text) < 5000
            text.encode()


def places(value: object, path: tuple = ()) -> list[tuple]:
    """The paths of all values below the document itself."""
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [place for key, child in children for place in [(*path, key), *places(child, (*path, key))]]


PLACES = places(VALID)


def test_the_valid_scene_is_valid() -> None:
    assert len(load(VALID).geometry) == 4


@settings(max_examples=200, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(document=JSON.map(lambda value: {"scene": value}))
def test_any_document(document: dict, tmp_path: Path) -> None:
    loads_or_complains(document, tmp_path)


@settings(max_examples=400, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_mutations_of_a_valid_scene(data: st.DataObject, tmp_path: Path) -> None:
    """Values replaced, removed, repeated or moved to other keys."""
    document = copy.deepcopy(VALID)
    for place in data.draw(st.lists(st.sampled_from(PLACES), min_size=1, max_size=3)):
        parent: object = document
        try:
            for key in place[:-1]:
                parent = parent[key]  # type: ignore[index]
            parent[place[-1]]  # type: ignore[index]
        except (KeyError, IndexError, TypeError):
            continue  # an earlier mutation took it away
        if not isinstance(parent, (dict, list)):
            continue
        change = data.draw(st.sampled_from(["replace", "remove", "rename", "duplicate"]))
        if change == "remove":
            del parent[place[-1]]
        elif change == "rename" and isinstance(parent, dict):
            parent[data.draw(WORDS)] = parent.pop(place[-1])
        elif change == "duplicate" and isinstance(parent, list):
            parent.append(copy.deepcopy(parent[place[-1]]))
        else:
            parent[place[-1]] = data.draw(JSON)
    loads_or_complains(document, tmp_path)


@settings(max_examples=300, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_mutations_of_the_text(data: st.DataObject, tmp_path: Path) -> None:
    """Bytes cut out, put in or overwritten."""
    text = json.dumps(VALID).encode()
    start = data.draw(st.integers(0, len(text)))
    length = data.draw(st.integers(0, 6))
    put = data.draw(st.binary(max_size=3) | st.sampled_from([b"[", b"{", b"]", b"}", b",", b'"', b"0", b"-", b"e9", b"1e999", b"/*", b"//", b"null"]))
    file = tmp_path / "s.json"
    file.write_bytes(text[:start] + put + text[start + length :])
    try:
        load(file)
    except SceneError as error:
        assert len(str(error).splitlines()) == 1
        assert str(error).startswith(str(file))
