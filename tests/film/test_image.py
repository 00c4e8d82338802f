"""Writing and reading back pictures."""

from __future__ import annotations

import json
import os
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from lumiere.errors import LumiereError, UsageError
from lumiere.film import write as write_module
from lumiere.film.encode import encode8
from lumiere.film.image import Image, check_output
from lumiere.film.record import write_record

RECORD = {"scene": "été.json", "seed": 7, "spp": np.int64(64), "rays": {"nearest": np.uint64(2**40)}}


def picture(height: int = 20, width: int = 30, **more: object) -> Image:
    pixels = np.random.default_rng(0).gamma(0.5, 2.0, (height, width, 3)).astype(np.float32)
    return Image(pixels=pixels, variance=pixels / 7.0, record=dict(RECORD), **more)


def read(path: Path) -> tuple[OpenImageIO.ImageSpec, np.ndarray]:
    file = OpenImageIO.ImageInput.open(str(path))
    return file.spec(), file.read_image(file.spec().format)


def test_exr_keeps_every_bit_of_the_radiance(tmp_path: Path) -> None:
    image = picture()
    image.pixels[0, 0] = [1e-30, 3e38, 0.0]
    image.save(tmp_path / "a.exr", exposure=5.0, tonemap="aces")
    spec, pixels = read(tmp_path / "a.exr")
    assert pixels.dtype == np.float32 and spec.channelnames == ("R", "G", "B")
    np.testing.assert_array_equal(pixels, image.pixels)


def test_exr_holds_the_layers_as_named_channels(tmp_path: Path) -> None:
    image = picture()
    height, width = image.pixels.shape[:2]
    rng = np.random.default_rng(3)
    image.aovs = {"albedo": rng.random((height, width, 3)), "normal": rng.normal(size=(height, width, 3)), "depth": rng.random((height, width)),
                  "position": rng.normal(size=(height, width, 3)), "uv": rng.random((height, width, 2)),
                  "material_id": np.arange(height * width).reshape(height, width), "object_id": np.zeros((height, width), np.uint32),
                  "sample_count": np.full((height, width), 64), "variance": image.variance}
    image.save(tmp_path / "a.exr")
    spec, pixels = read(tmp_path / "a.exr")
    by_name = {name: pixels[..., c] for c, name in enumerate(spec.channelnames)}
    assert set(by_name) == {
        "R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z", "position.X", "position.Y", "position.Z",
        "uv.U", "uv.V", "material_id.id", "object_id.id", "sample_count.N", "variance.R", "variance.G", "variance.B"}
    for c, name in enumerate("XYZ"):
        np.testing.assert_array_equal(by_name[f"normal.{name}"], image.aovs["normal"][..., c].astype(np.float32))
    np.testing.assert_array_equal(by_name["uv.V"], image.aovs["uv"][..., 1].astype(np.float32))
    np.testing.assert_array_equal(by_name["material_id.id"], image.aovs["material_id"])
    np.testing.assert_array_equal(by_name["variance.G"], image.variance[..., 1])
    np.testing.assert_array_equal(by_name["R"], image.pixels[..., 0])


def test_exr_says_how_it_was_made(tmp_path: Path) -> None:
    picture().save(tmp_path / "a.exr")
    spec, _ = read(tmp_path / "a.exr")
    assert json.loads(spec["lumiere:record"]) == {"scene": "été.json", "seed": 7, "spp": 64, "rays": {"nearest": 2**40}}
    assert spec["lumiere:scene"] == "été.json" and spec["lumiere:seed"] == "7" and spec["lumiere:spp"] == "64"


def test_a_crop_is_a_data_window_inside_the_display_window(tmp_path: Path) -> None:
    image = picture(crop=(5, 6, 35, 26), full_size=(64, 48))
    image.save(tmp_path / "a.exr")
    image.save(tmp_path / "a.png")
    spec, pixels = read(tmp_path / "a.exr")
    assert (spec.x, spec.y, spec.width, spec.height) == (5, 6, 30, 20)
    assert (spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (0, 0, 64, 48)
    np.testing.assert_array_equal(pixels, image.pixels)
    assert read(tmp_path / "a.png")[1].shape == (20, 30, 3)


@pytest.mark.parametrize("tonemap", ["none", "agx"])
def test_png_is_the_encoded_picture_top_row_first(tmp_path: Path, tonemap: str) -> None:
    image = picture()
    image.pixels[0] = 0.0
    image.save(tmp_path / "a.PNG", exposure=-1.0, tonemap=tonemap)
    spec, pixels = read(tmp_path / "a.PNG")
    assert spec.format == OpenImageIO.TypeDesc("uint8")
    np.testing.assert_array_equal(pixels, encode8(image.pixels, -1.0, tonemap))
    assert not pixels[0].any() and pixels[1:].any()


def test_jpeg_is_near_the_encoded_picture(tmp_path: Path) -> None:
    ramp = np.linspace(0.0, 1.0, 64, dtype=np.float32)[None, :, None] * np.ones((64, 1, 3), np.float32)
    image = Image(pixels=ramp)
    image.save(tmp_path / "a.jpg")
    _, pixels = read(tmp_path / "a.jpg")
    difference = pixels.astype(int) - encode8(ramp).astype(int)
    assert np.sqrt(np.mean(difference**2.0)) < 1.5, "quality 95 of a ramp is within a code or two"


def test_notebooks_get_a_png() -> None:
    assert picture()._repr_png_().startswith(b"\x89PNG\r\n")


def test_numpy_takes_an_image_as_its_pixels() -> None:
    image = picture()
    assert np.asarray(image) is image.pixels
    copy = np.array(image, dtype=np.float64)
    copy[:] = -1.0
    assert image.pixels.min() >= 0.0
    assert float(np.mean(image)) == float(image.pixels.mean())


@pytest.mark.parametrize("arguments", [
    {"crop": (0, 0, 29, 20)}, {"crop": (1, 0, 31, 20)}, {"crop": (40, 0, 70, 20), "full_size": (64, 48)}, {"full_size": (10, 10)}])
def test_a_crop_that_is_not_the_pixels_place_is_refused(arguments: dict) -> None:
    with pytest.raises(ValueError, match="expected"):
        picture(**arguments)


@pytest.mark.parametrize(("name", "message"), [
    ("a.webp", r"cannot write .*a\.webp: its name ends in '\.webp', expected one of \.exr, \.png, \.jpg, \.jpeg"),
    ("a", "its name has no suffix"),
    ("missing/a.png", "there is no folder .*missing; make it first"),
    ("folder.png", "it is a folder"),
])
def test_an_output_that_cannot_be_is_refused_beforehand(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(UsageError, match=message) as raised:
        check_output(tmp_path / name)
    assert "\n" not in str(raised.value)
    with pytest.raises(UsageError, match=message):
        picture().save(tmp_path / name)
    assert [p.name for p in tmp_path.iterdir()] == ["folder.png"]


def test_a_jpeg_that_is_too_large_is_refused_beforehand(tmp_path: Path) -> None:
    check_output(tmp_path / "a.jpg", (65500, 2))
    check_output(tmp_path / "a.png", (65536, 2))
    with pytest.raises(UsageError, match=r"found 65536 × 2 pixels, expected at most 65500"):
        check_output(tmp_path / "a.jpg", (65536, 2))


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="needs a folder that takes no file even from root")
def test_a_folder_that_takes_no_file_is_refused_beforehand() -> None:
    with pytest.raises(UsageError, match=r"cannot write /proc/self/a\.png: its folder takes no new file"):
        check_output("/proc/self/a.png")


def test_checking_leaves_nothing_and_touches_nothing(tmp_path: Path) -> None:
    target = tmp_path / "a.png"
    check_output(target)
    assert list(tmp_path.iterdir()) == []
    target.write_text("before")
    check_output(target)
    assert target.read_text() == "before" and list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("error", [OSError("no space left"), KeyboardInterrupt()])
def test_a_failed_write_leaves_the_old_file_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    target = tmp_path / "a.png"
    target.write_text("before")

    def fail(image: Image, path: Path, exposure: float, tonemap: str) -> None:
        path.write_text("half")
        raise error

    monkeypatch.setitem(write_module._WRITERS, ".png", fail)
    with pytest.raises(LumiereError if isinstance(error, OSError) else KeyboardInterrupt):
        picture().save(target)
    assert target.read_text() == "before" and list(tmp_path.iterdir()) == [target]


FULL_DISK = """
import resource, signal, sys
import numpy as np
from lumiere.errors import LumiereError
from lumiere.film.image import Image
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
try:
    Image(pixels=np.random.default_rng(0).random((256, 256, 3), dtype=np.float32)).save(sys.argv[1])
except LumiereError as error:
    assert str(error).startswith("cannot write " + sys.argv[1]) and "\\n" not in str(error), str(error)
    sys.exit(7)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs file-size limits")
@pytest.mark.parametrize("suffix", ["exr", "png", "jpg"])
def test_a_file_that_cannot_grow_is_an_error_and_is_removed(tmp_path: Path, suffix: str) -> None:
    done = subprocess.run([sys.executable, "-c", FULL_DISK, str(tmp_path / f"a.{suffix}")], capture_output=True, text=True, check=False)
    assert done.returncode == 7, done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_replaced_file_keeps_its_rights_and_a_new_one_gets_the_umasks(tmp_path: Path) -> None:
    target = tmp_path / "a.png"
    picture().save(target)
    umask = os.umask(0o022)
    os.umask(umask)
    assert stat.S_IMODE(target.stat().st_mode) == 0o666 & ~umask
    target.chmod(0o640)
    picture().save(target)
    assert stat.S_IMODE(target.stat().st_mode) == 0o640


def test_a_link_is_followed(tmp_path: Path) -> None:
    (tmp_path / "link.png").symlink_to(tmp_path / "real.png")
    picture().save(tmp_path / "link.png")
    assert (tmp_path / "link.png").is_symlink() and read(tmp_path / "real.png")[1].shape == (20, 30, 3)


def test_the_record_is_json(tmp_path: Path) -> None:
    write_record(RECORD | {"path": Path("x"), "crop": (1, 2, 3, 4)}, tmp_path / "r.json")
    loaded = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    assert loaded["rays"]["nearest"] == 2**40 and loaded["scene"] == "été.json" and loaded["path"] == "x" and loaded["crop"] == [1, 2, 3, 4]
