"""Builds the wheel and the sdist, installs each in an environment of its own, and looks for the OpenCL sources from another folder."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

LOCATE = """
import pathlib, lumiere.paths
root = lumiere.paths.cl_root()
print(root)
print("\\n".join(sorted(str(p.relative_to(root)) for p in root.rglob("*.cl"))))
"""


def run(*command: str | Path, cwd: Path) -> str:
    return subprocess.run([str(part) for part in command], cwd=cwd, check=True, stdout=subprocess.PIPE, text=True).stdout


def check(kind: str, what: list[str | Path], folder: Path, expected: list[str]) -> bool:
    """Installs ``what`` without its dependencies and compares the sources that it finds with ``expected``."""
    environment = folder / kind
    venv.create(environment, with_pip=True)
    run(environment / "bin" / "pip", "install", "--quiet", "--no-deps", *what, cwd=ROOT)
    place, *files = run(environment / "bin" / "python", "-c", LOCATE, cwd=folder).splitlines()
    version = run(environment / "bin" / "python", "-c", "import lumiere; print(lumiere.__version__)", cwd=folder).strip()
    right = files == expected and (Path(place).is_relative_to(ROOT) == (kind == "editable"))
    print(f"{kind} {version}: {len(files)} of {len(expected)} OpenCL sources, {'as expected' if right else f'found in {place}: {files}'}")
    return right


def main() -> int:
    expected = sorted(str(path.relative_to(ROOT / "cl")) for path in (ROOT / "cl").rglob("*.cl"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        build = folder / "build"
        venv.create(build, with_pip=True)
        run(build / "bin" / "pip", "install", "--quiet", "build", cwd=folder)
        run(build / "bin" / "python", "-m", "build", "--outdir", folder, ROOT, cwd=folder)  # the wheel is made from the sdist
        [wheel], [sdist] = folder.glob("*.whl"), folder.glob("*.tar.gz")
        results = [check("wheel", [wheel], folder, expected), check("sdist", [sdist], folder, expected),
                   check("editable", ["--editable", ROOT], folder, expected)]
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
