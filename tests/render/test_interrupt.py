"""A signal while a real device is being used."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pyopencl as cl

from tests.render.scenes import index_of

COMPILING = """
import os
import sys
import lumiere.device.program as program
from lumiere.cli.main import command

build = program.build

def told(*arguments):
    os.write(1, b"compiling\\n")  # in one piece, since programs compile side by side
    return build(*arguments)

program.build = told
sys.exit(command())
"""


def test_while_programs_compile_it_ends_the_process_at_once(device: cl.Device, tmp_path: Path) -> None:
    """Neither a driver's last words nor its exit status, which an exception that passes through it would bring."""
    scene, picture = tmp_path / "ball.json", tmp_path / "ball.png"
    scene.write_text('{"scene": {"geometry": [{"type": "sphere"}]}}')
    caches = {name: str(tmp_path / "caches") for name in ("LUMIERE_CACHE", "POCL_CACHE_DIR")}
    command = [sys.executable, "-c", COMPILING, "render", str(scene), "-o", str(picture), "--device", str(index_of(device))]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               env=os.environ | caches | {"PYTHONPATH": os.pathsep.join(sys.path)})
    assert process.stdout.readline() == "compiling\n"
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (130, "lumiere: interrupted; nothing written\n")
    assert not picture.exists()
