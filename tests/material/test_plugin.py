"""docs/adding-a-material.md, followed to the letter: two files and an entry point are a material, which renders and passes the registry's tests."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
PAGE = REPOSITORY / "docs" / "adding-a-material.md"

RENDER = """
import lumiere
scene = {"film": {"width": 8, "height": 8}, "geometry": [{"type": "sphere", "position": [0, 0, 0], "radius": 1,
         "material": {"type": "minnaert", "albedo": 0.5, "k": 1}}], "camera": {"position": [0, 0, 9], "look_at": [0, 0, 0], "fov": 5}}
pixels = lumiere.render({"scene": scene}, spp=64).pixels
assert abs(pixels.mean() - 0.5) < 0.01, pixels.mean()
"""


@pytest.fixture
def plugin(tmp_path: Path) -> Path:
    """A folder with the page's files and the metadata that installing them would have left."""
    text = PAGE.read_text(encoding="utf-8")
    files = re.findall(r"^`([\w.]+)`:\n\n```\w+\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert [name for name, _ in files] == ["minnaert.py", "minnaert.cl"]
    for name, content in files:
        (tmp_path / name).write_text(content, encoding="utf-8")
    group, point = re.search(r'^\[project\.entry-points\."([\w.]+)"\]\n(\w+) = "(?:\w+)"$', text, re.MULTILINE).groups()  # type: ignore[union-attr]
    metadata = tmp_path / "minnaert-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: minnaert\nVersion: 1.0\n", encoding="utf-8")
    (metadata / "entry_points.txt").write_text(f"[{group}]\n{point} = minnaert\n", encoding="utf-8")
    return tmp_path


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), str(REPOSITORY)])}
    return subprocess.run([sys.executable, *arguments], cwd=REPOSITORY, env=environment, capture_output=True, text=True, timeout=300, check=False)


def test_the_pages_material_renders(plugin: Path) -> None:
    done = run(plugin, "-c", RENDER)
    assert done.returncode == 0, done.stderr


def test_the_pages_material_passes_the_registrys_tests(plugin: Path) -> None:
    done = run(plugin, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/bsdf", "-k", "minnaert and (density or energy or reciprocity or extremes)")
    assert done.returncode == 0, done.stdout
    passed = re.search(r"\b(\d+) passed", done.stdout)
    assert passed is not None and int(passed[1]) >= 20, done.stdout  # on each device


def test_a_broken_plugin_is_one_line(plugin: Path) -> None:
    (plugin / "minnaert.py").write_text("import nothing_of_this_name\n", encoding="utf-8")
    done = run(plugin, "-c", "from lumiere.errors import PluginError\nfrom lumiere.bsdf import MATERIALS\ntry:\n    MATERIALS.kinds()\n"
                             "except PluginError as error:\n    print(error)\n")
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") == 1 and "'minnaert'" in done.stdout and "nothing_of_this_name" in done.stdout
