"""The command line, with a render that is quick and made up."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lumiere import api
from lumiere.cli.main import main
from lumiere.cli.progress import ProgressDisplay
from lumiere.cli.values import clock, with_prefix
from lumiere.errors import DeviceError, LumiereError
from lumiere.film.image import Image
from lumiere.film.progress import Progress

RECORD = {"spp": 64, "samples_per_second": 1.5e6, "device": "Fake", "seconds": {"render": 2.5}, "non_finite": {"count": 0, "samples": []}}
SCENE = '{"scene": {"geometry": [{"type": "sphere", "position": [0, 0, 0], "radius": 2}], "film": {"width": 8, "height": 4, "exposure": 1}}}'


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "scenes" / "ball.json"
    path.parent.mkdir()
    path.write_text(SCENE)
    return path


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """What the stand-in for the renderer was asked for."""
    seen: list[dict[str, Any]] = []

    def render(scene: Any, *, progress: Any, stop: Any, **options: Any) -> Image:
        seen.append(options)
        progress(Progress(32, 64, 0.5))
        return Image(pixels=np.full((4, 8, 3), 0.25, np.float32), record=dict(RECORD) | {"interrupted": stop()})

    monkeypatch.setattr(api, "render", render)
    return seen


def test_the_default_output_is_the_scenes_name_here(scene: Path, calls: list, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["render", str(scene)]) == 0
    assert calls == [{}]
    assert Path("ball.png").read_bytes().startswith(b"\x89PNG")
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == "lumiere: wrote ball.png (64 spp in 2.5 s, 1.5 Msamples/s, Fake)\n"


def test_options_go_to_the_renderer_as_they_are(scene: Path, calls: list) -> None:
    assert main(["render", str(scene), "--spp", "7", "--seed", "0", "--width", "8", "--height", "4", "--crop", "0", "1", "2", "3",
                 "--max-depth", "0", "--device", "1", "--time-limit", "1.5"]) == 0
    assert calls == [{"spp": 7, "seed": 0, "width": 8, "height": 4, "crop": [0, 1, 2, 3], "max_depth": 0, "device": "1", "time_limit": 1.5}]


def test_every_output_and_the_record_are_written(scene: Path, calls: list) -> None:
    assert main(["render", str(scene), "-o", "a.exr", "--output", "b.jpg", "-o", "c.PNG", "--record", "r.json"]) == 0
    assert {p.name for p in Path().iterdir()} == {"scenes", "a.exr", "b.jpg", "c.PNG", "r.json"}
    assert json.loads(Path("r.json").read_text())["device"] == "Fake"


def test_pngs_get_the_scenes_exposure(scene: Path, calls: list) -> None:
    from lumiere.imagefile import read_image

    assert main(["render", str(scene)]) == 0
    # 0.25 at one stop is 0.5, whose sRGB code is 188.
    np.testing.assert_array_equal(read_image("ball.png"), 188)


@pytest.mark.parametrize(("arguments", "status", "message"), [
    ([], 2, "the following arguments are required: COMMAND; see `lumiere --help`"),
    (["paint"], 2, "argument COMMAND: invalid choice: 'paint'"),
    (["render"], 2, "the following arguments are required: SCENE"),
    (["render", "SCENE", "--sp", "3"], 2, "unrecognized arguments: --sp 3"),
    (["render", "SCENE", "--spp", "0"], 2, "argument --spp: found '0', expected a whole number from 1 to 2147483647"),
    (["render", "SCENE", "--spp", "many"], 2, "argument --spp: found 'many', expected a whole number"),
    (["render", "SCENE", "--time-limit", "nan"], 2, "argument --time-limit: found 'nan', expected seconds above 0"),
    (["render", "SCENE", "--crop", "1", "2"], 2, "argument --crop: expected 4 arguments"),
    (["render", "SCENE", "-o", "a.bmp"], 2, "cannot write a.bmp: its name ends in '.bmp', expected one of .exr, .png, .jpg, .jpeg"),
    (["render", "SCENE", "-o", "none/a.png"], 2, "cannot write none/a.png: there is no folder none; make it first"),
    (["render", "SCENE", "--record", "none/r.json"], 2, "cannot write none/r.json: there is no folder none"),
    (["render", "SCENE", "--record", "SCENE"], 2, "it is the scene"),
    (["render", "SCENE", "-o", "a.png", "-o", "./a.png"], 2, "it is already another output"),
    (["render", "none.json"], 2, "none.json: "),
    (["validate", "none.json"], 2, "none.json: "),
])
def test_what_is_wrong_is_one_line_before_anything_is_rendered(
        scene: Path, calls: list, capsys: pytest.CaptureFixture[str], arguments: list[str], status: int, message: str) -> None:
    assert main([str(scene) if a == "SCENE" else a for a in arguments]) == status
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.startswith("lumiere: ") and message in captured.err
    assert captured.err.count("\n") == 1
    assert calls == [] and [p.name for p in Path().iterdir()] == ["scenes"] and scene.read_text() == SCENE


def test_a_wrong_scene_is_file_line_and_column_as_given(scene: Path, calls: list, capsys: pytest.CaptureFixture[str]) -> None:
    scene.write_text('{"scene": {\n  "lamps": []}}')
    for command in ("render", "validate"):
        assert main([command, "scenes/ball.json"]) == 2
        assert capsys.readouterr().err.startswith("lumiere: scenes/ball.json:2:3: ")
    assert calls == []


def test_a_device_error_has_its_own_status(scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def render(*_: Any, **__: Any) -> Image:
        raise DeviceError("found no OpenCL device")

    monkeypatch.setattr(api, "render", render)
    assert main(["render", str(scene)]) == 3
    assert capsys.readouterr().err == "lumiere: found no OpenCL device\n"
    assert not Path("ball.png").exists()


def test_a_defect_keeps_its_traceback(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(api, "render", lambda *_, **__: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        main(["render", str(scene)])


def test_one_output_that_fails_does_not_lose_the_others(
        scene: Path, calls: list, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    save = Image.save

    def failing(self: Image, path: Path, *more: Any) -> None:
        if path.suffix == ".exr":
            raise LumiereError(f"cannot write {path}: No space left on device")
        save(self, path, *more)

    monkeypatch.setattr(Image, "save", failing)
    assert main(["render", str(scene), "-o", "a.exr", "-o", "b.png"]) == 1
    assert Path("b.png").is_file()
    assert capsys.readouterr().err == "lumiere: cannot write a.exr: No space left on device\n"


def test_samples_that_are_not_finite_are_told(
        scene: Path, calls: list, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setitem(RECORD, "non_finite", {"count": 3, "samples": []})
    assert main(["render", str(scene)]) == 0
    assert capsys.readouterr().err.endswith("; 3 samples were not finite and count as 0\n")


def test_validate_says_that_a_scene_is_valid(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "scenes/ball.json"]) == 0
    assert capsys.readouterr().out == "scenes/ball.json: valid (1 shape, 0 lights, 0 materials, 0 textures)\n"


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as raised:
        main(["--version"])
    assert raised.value.code == 0 and capsys.readouterr().out == "lumiere 0.1.0\n"


def test_devices_are_listed_with_the_default_marked(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    from lumiere.device import select

    gpu = select.DeviceInfo(1, "H100", "NVIDIA CUDA", "gpu", "OpenCL 3.0", "1.2", 132, 80 << 30, 20 << 30)
    cpu = select.DeviceInfo(0, "CPU", "Some", "cpu", "v1", "1.2", 2, 4 << 30, 2 << 30)
    monkeypatch.setattr(select, "list_devices", lambda: [cpu, select.DeviceInfo(None, "", "Clover", error="no device"), gpu])
    monkeypatch.delenv("LUMIERE_DEVICE", raising=False)
    assert main(["devices"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "  0  CPU (cpu): Some", "       v1; OpenCL C 1.2; 2 compute units; 4.0 GiB, 2.0 GiB in one buffer",
        "  -  Clover: no device",
        "* 1  H100 (gpu): NVIDIA CUDA", "       OpenCL 3.0; OpenCL C 1.2; 132 compute units; 80.0 GiB, 20.0 GiB in one buffer"]
    monkeypatch.setattr(select, "list_devices", list)
    assert main(["devices"]) == 3
    assert "found no OpenCL device" in capsys.readouterr().err


INTERRUPTIBLE = """
import sys, time
import numpy as np
from lumiere import api
from lumiere.cli.main import main
from lumiere.film.image import Image
from lumiere.film.progress import Progress

def render(scene, *, progress, stop, **options):
    done = 0
    if first_batch == "never":
        print("ready", flush=True)
        time.sleep(60)
    while not stop() or stubborn:
        done += 1
        progress(Progress(done, 1000000, done * 0.01))
        if done == 1:
            print("ready", flush=True)
        time.sleep(0.01)
    return Image(pixels=np.zeros((4, 8, 3), np.float32), record={"spp": done, "device": "Fake"})

api.render = render
first_batch, stubborn = sys.argv[1], sys.argv[2] == "stubborn"
sys.exit(main(["render", "scenes/ball.json", "-o", "a.png"]))
"""


def interruptible(first_batch: str, patience: str = "") -> subprocess.Popen[str]:
    process = subprocess.Popen([sys.executable, "-c", INTERRUPTIBLE, first_batch, patience], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})
    assert process.stdout.readline() == "ready\n", process.stderr.read()
    return process


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_writes_what_is_there(scene: Path, number: signal.Signals) -> None:
    process = interruptible("soon")
    process.send_signal(number)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "lumiere: interrupted; wrote a.png (" in err and "Traceback" not in err
    assert Path("a.png").is_file()


def test_a_signal_before_the_first_batch_writes_nothing(scene: Path) -> None:
    process = interruptible("never")
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (130, "lumiere: interrupted; nothing written\n")
    assert not Path("a.png").exists()


def test_a_second_signal_ends_at_once(scene: Path) -> None:
    process = interruptible("soon", "stubborn")
    process.send_signal(signal.SIGINT)
    time.sleep(0.2)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 130 and err.endswith("lumiere: interrupted; nothing written\n")
    assert [p.name for p in Path().iterdir()] == ["scenes"]


class Stream:
    def __init__(self, terminal: bool) -> None:
        self.text = ""
        self.terminal = terminal

    def isatty(self) -> bool:
        return self.terminal

    def write(self, text: str) -> None:
        self.text += text

    def flush(self) -> None:
        pass


def test_plain_progress_is_a_line_now_and_then() -> None:
    stream = Stream(False)
    display = ProgressDisplay(stream)
    for done in range(1, 1201):
        display(Progress(done * 10_000, 12_000_000, done / 100.0))
    display.close()
    assert stream.text == "lumiere:  42 %, 1 Msamples/s, 0:07 left\nlumiere:  83 %, 1 Msamples/s, 0:02 left\n"


def test_a_terminal_gets_one_line_that_is_redrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    stream = Stream(True)
    display = ProgressDisplay(stream)
    for done in range(1, 101):
        display(Progress(done, 100, done / 25.0))
    display.close()
    states = stream.text.removesuffix("\n").split("\r")[1:]
    assert "\n" not in stream.text[:-1] and 30 < len(states) <= 40
    assert all(len(state) < 60 for state in states)
    assert states[-1].rstrip() == f"[{'#' * 36}] 100 %, 25 samples/s"
    assert states[10].startswith("[#####") and states[10].rstrip().endswith("%, 25 samples/s, 0:03 left")


def test_a_narrow_terminal_is_not_overrun(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "20")
    stream = Stream(True)
    ProgressDisplay(stream)(Progress(1, 10**9, 1.0))
    assert len(stream.text) <= 20


def test_a_real_terminal_shows_the_bar(scene: Path) -> None:
    leader, follower = pty.openpty()
    process = subprocess.Popen([sys.executable, "-c", INTERRUPTIBLE, "soon", ""], stdout=subprocess.PIPE, stderr=follower, text=True,
                               env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), "COLUMNS": "80"})
    os.close(follower)
    assert process.stdout.readline() == "ready\n"
    shown = b""
    while b"left" not in shown:
        shown += os.read(leader, 1000)
    process.send_signal(signal.SIGTERM)
    process.wait(timeout=30)
    shown += os.read(leader, 100_000)
    os.close(leader)
    assert b"\r[" in shown and b"\r\nlumiere: interrupted; wrote a.png" in shown


@pytest.mark.parametrize(("value", "text"), [
    (0.0, "0 x"), (999.0, "999 x"), (999.7, "1 kx"), (12_345.0, "12.3 kx"), (1.5e6, "1.5 Mx"), (123_456_789.0, "123 Mx"), (5e12, "5000 Gx")])
def test_rates_have_three_digits(value: float, text: str) -> None:
    assert with_prefix(value, "x") == text


def test_clock() -> None:
    assert [clock(s) for s in (0, 59.4, 60, 3599.6, 7261)] == ["0:00", "0:59", "1:00", "1:00:00", "2:01:01"]


def test_progress_knows_the_rate_and_the_time_left() -> None:
    progress = Progress(25, 100, 5.0)
    assert (progress.fraction, progress.samples_per_second, progress.seconds_left) == (0.25, 5.0, 15.0)
    assert Progress(0, 100, 0.0).seconds_left is None and Progress(0, 0, 0.0).fraction == 1.0


def test_the_command_starts_quickly_and_loads_no_device_for_its_help() -> None:
    code = "import sys; import lumiere.cli.main as m; m.parser(); print({'pyopencl', 'OpenImageIO', 'trimesh', 'PIL'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_a_reader_that_goes_away_is_no_error(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = "import sys; from lumiere.cli.main import main; sys.exit(main(['validate', 'scenes/ball.json']))"
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})
    process.stdout.close()
    assert process.wait(timeout=60) == 1 and process.stderr.read() == ""


def test_a_size_too_large_for_jpeg_is_refused(scene: Path, calls: list, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["render", str(scene), "--width", "65536", "-o", "a.jpg"]) == 2
    assert "expected at most 65500" in capsys.readouterr().err and calls == []
    assert main(["render", str(scene), "--width", "65536", "--crop", "0", "0", "8", "4", "-o", "a.jpg"]) == 0


def test_main_takes_its_arguments_from_the_process(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["lumiere", "render", "none.json"])
    assert main() == 2
    assert capsys.readouterr().err.startswith("lumiere: none.json: ")


@pytest.mark.parametrize(("arguments", "status", "said"), [(["--version"], 0, "lumiere 0.1.0\n"), (["validate", "none.json"], 2, "")])
def test_the_process_ends_with_the_commands_status(tmp_path: Path, arguments: list[str], status: int, said: str) -> None:
    done = subprocess.run([sys.executable, "-m", "lumiere", *arguments], cwd=tmp_path, env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
                          capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (status, said) and "Traceback" not in done.stderr


def test_what_a_command_has_said_is_not_lost_with_the_process() -> None:
    """The process ends at once, but not before its output is out: also that of a command that fails half way."""
    code = """if True:
        import sys
        from lumiere.cli import main, validate
        from lumiere.errors import LumiereError
        def run(options):
            sys.stdout.write("half\\n")
            if options.scene == "bad":
                raise LumiereError("the other half")
            return 0
        validate.run = run
        main.command()
    """
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    for scene, status, error in (("good", 0, ""), ("bad", 1, "lumiere: the other half\n")):
        done = subprocess.run([sys.executable, "-c", code, "validate", scene], env=buffered, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout, done.stderr) == (status, "half\n", error)
