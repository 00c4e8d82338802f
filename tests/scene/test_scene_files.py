"""Files and arrays that turn out wrong when they are read: the message says where in the scene that stands."""

from __future__ import annotations

from pathlib import Path

import pytest

from lumiere.cli.main import main
from lumiere.compile.scene import compile_scene
from lumiere.errors import SceneError
from lumiere.scene.load import load

TRIANGLE = '"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]'

CASES = {
    "broken mesh": ('{"scene": {"geometry": [{"type": "mesh",\n  "file": §"lie.ply"}]}}', "scene.geometry[0].file", "lie.ply: found "),
    "broken picture": ('{"scene": {"textures": {"t": {"type": "image", "file": §"lie.png"}}, "materials": {"m": {"type": "lambert", "albedo": '
                       '{"texture": "t"}}}, "geometry": [{"type": "sphere", "material": "m"}]}}', "scene.textures.t.file", "lie.png: found no picture"),
    "broken picture, inline": ('{"scene": {"geometry": [{"type": "sphere", "emission": {"type": "image", "file": §"lie.png"}}]}}',
                               "scene.geometry[0].emission.file", "lie.png: found no picture"),
    "broken environment": ('{"scene": {"lights": [{"type": "environment", "file": §"lie.png"}]}}', "scene.lights[0].file", "lie.png: found no picture"),
    "two environments": ('{"scene": {"lights": [{"type": "environment", "file": "lie.png"},\n§{"type": "environment", "file": "lie.png"}]}}',
                         "scene.lights[1]", "found a second environment with a file, expected at most one"),
    "no area": ('{"scene": {"geometry": [§{"type": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "faces": [[0, 1, 2]]}]}}',
                "scene.geometry[0]", "found no usable triangle, expected at least one"),
    "index too large": (f'{{"scene": {{"geometry": [§{{"type": "mesh", {TRIANGLE}, "faces": [[0, 1, 2], [0, 1, 3]]}}]}}}}',
                        "scene.geometry[0]", "found a face with vertex 3, expected one of the 3 vertices, 0 to 2"),
    "index below 0": (f'{{"scene": {{"geometry": [§{{"type": "mesh", {TRIANGLE}, "faces": [[0, 1, -1]]}}]}}}}',
                      "scene.geometry[0]", "found a face with vertex -1, expected one of the 3 vertices, 0 to 2"),
}


@pytest.mark.parametrize(("marked", "path", "words"), CASES.values(), ids=CASES)
def test_complaint_says_where(tmp_path: Path, marked: str, path: str, words: str) -> None:
    for name in ("lie.ply", "lie.png"):
        (tmp_path / name).write_text("ply\nno more")
    scene = tmp_path / "s.json"
    scene.write_text(marked.replace("§", ""), encoding="utf-8")
    before = marked[: marked.index("§")]
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    with pytest.raises(SceneError) as caught:
        compile_scene(load(scene))
    text = str(caught.value)
    assert text.startswith(f"{scene}:{line}:{column}: {path}: ") and words in text
    assert len(text.splitlines()) == 1 and caught.value.exit_status == 2


def test_validate_reads_pictures_that_nothing_uses(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "lie.png").touch()
    scene = tmp_path / "s.json"
    scene.write_text('{"scene": {"textures": {"t": {"type": "image", "file": "lie.png"}}}}')
    assert main(["validate", str(scene)]) == 2
    assert capsys.readouterr().err.startswith(f"lumiere: {scene}:1:56: scene.textures.t.file: {tmp_path}/lie.png: found no picture")
