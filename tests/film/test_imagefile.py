"""Reading pictures: what comes in is what was stored, or one clear line."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import OpenImageIO
import PIL.Image
import pytest

from lumiere.errors import SceneError
from lumiere.imagefile import as_pixels, read_image

ASSETS = Path(__file__).parents[3] / "shared" / "assets"


def store(path: Path, pixels: np.ndarray, names: tuple[str, ...] = (), kind: str | None = None, **attributes: object) -> Path:
    """Writes ``pixels`` with OpenImageIO; ``kind`` is the type of the values in the file."""
    height, width, channels = pixels.shape
    spec = OpenImageIO.ImageSpec(width, height, channels, kind or str(pixels.dtype).replace("float32", "float").replace("float16", "half"))
    if names:
        spec.channelnames = names
    for name, value in attributes.items():
        if hasattr(spec, name):
            setattr(spec, name, value)
        else:
            spec.attribute(name, value)
    out = OpenImageIO.ImageOutput.create(str(path))
    assert out.open(str(path), spec) and out.write_image(pixels) and out.close(), out.geterror()
    return path


def noise(channels: int, dtype: type = np.uint8, height: int = 12, width: int = 20) -> np.ndarray:
    rng = np.random.default_rng(channels)
    if dtype is np.uint8:
        return rng.integers(0, 256, (height, width, channels), dtype=np.uint8)
    return rng.gamma(0.5, 3.0, (height, width, channels)).astype(dtype)


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("suffix", ["png", "tif"])
def test_8bit_values_come_as_stored(tmp_path: Path, channels: int, suffix: str) -> None:
    stored = noise(channels)
    # Pillow writes alpha unassociated, as the formats say; what is read must not be multiplied by it.
    PIL.Image.fromarray(stored.squeeze() if channels == 1 else stored).save(tmp_path / f"a.{suffix}")
    pixels = read_image(tmp_path / f"a.{suffix}")
    assert pixels.dtype == np.uint8
    np.testing.assert_array_equal(pixels, stored)


def test_jpeg_is_8bit_with_the_top_row_first(tmp_path: Path) -> None:
    stored = np.zeros((32, 16, 3), np.uint8)
    stored[:16] = [200, 100, 50]
    PIL.Image.fromarray(stored).save(tmp_path / "a.jpg", quality=100, subsampling="4:4:4")
    pixels = read_image(tmp_path / "a.jpg")
    assert pixels.dtype == np.uint8
    assert np.abs(pixels.astype(int) - stored).max() <= 3


def test_16bit_values_are_scaled(tmp_path: Path) -> None:
    stored = np.random.default_rng(0).integers(0, 65536, (5, 7, 3), dtype=np.uint16)
    pixels = read_image(store(tmp_path / "a.png", stored))
    assert pixels.dtype == np.float32
    np.testing.assert_allclose(pixels, stored / 65535.0, rtol=2e-7)


@pytest.mark.parametrize("channels", [1, 3, 4])
@pytest.mark.parametrize("compression", ["none", "zip", "piz"])
def test_exr_floats_come_bit_by_bit(tmp_path: Path, channels: int, compression: str) -> None:
    stored = noise(channels, np.float32)
    np.testing.assert_array_equal(read_image(store(tmp_path / "a.exr", stored, compression=compression)), stored)


def test_lossy_exr_is_read(tmp_path: Path) -> None:
    smooth = (np.linspace(0.0, 1.0, 64)[:, None, None] * np.ones((1, 64, 3))).astype(np.float32)
    np.testing.assert_allclose(read_image(store(tmp_path / "a.exr", smooth, kind="half", compression="dwab")), smooth, atol=0.01)


def test_hdr_values_have_a_shared_exponent(tmp_path: Path) -> None:
    stored = noise(3, np.float32)
    pixels = read_image(store(tmp_path / "a.hdr", stored))
    # RGBE keeps 8 bits of the largest channel, so each is within 1/128 of the largest.
    assert np.all(np.abs(pixels - stored) <= stored.max(axis=2, keepdims=True) / 128.0)


@pytest.mark.parametrize(("names", "taken"), [
    (("R", "G", "B", "Z"), "RGB"), (("A", "B", "G", "R", "albedo.R"), "RGBA"), (("Y", "depth.Z"), "Y"), (("a.X", "a.Y", "a.Z"), None)])
def test_colour_is_taken_from_among_layers(tmp_path: Path, names: tuple[str, ...], taken: str | None) -> None:
    stored = noise(len(names), np.float32)
    expected = stored if taken is None else stored[..., [names.index(name) for name in taken]]
    np.testing.assert_array_equal(read_image(store(tmp_path / "a.exr", stored, names)), expected)


def test_a_cropped_exr_fills_its_display_window(tmp_path: Path) -> None:
    stored = noise(3, np.float32)
    pixels = read_image(store(tmp_path / "a.exr", stored, x=3, y=-2, full_x=0, full_y=0, full_width=30, full_height=15))
    expected = np.zeros((15, 30, 3), np.float32)
    expected[0:10, 3:23] = stored[2:]
    np.testing.assert_array_equal(pixels, expected)


def test_values_that_are_not_finite_are_counted_and_zeroed(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    stored = noise(3, np.float32)
    stored[0, 0] = [np.nan, np.inf, -np.inf]
    path = store(tmp_path / "a.exr", stored)
    pixels = read_image(path)
    assert caplog.messages == [f"{path}: 3 of 720 values are NaN or infinite; they are taken as 0"]
    assert not pixels[0, 0].any()
    np.testing.assert_array_equal(pixels[1:], stored[1:])


@pytest.mark.parametrize("suffix", ["png", "jpg", "exr", "hdr", "tif"])
@pytest.mark.parametrize("fraction", [0.0, 0.02, 0.3, 0.75])
def test_a_truncated_file_is_one_line_and_no_noise(tmp_path: Path, suffix: str, fraction: float, capfd: pytest.CaptureFixture[str]) -> None:
    stored = noise(3, np.float32 if suffix in ("exr", "hdr") else np.uint8, 64, 64)
    path = store(tmp_path / f"a.{suffix}", stored)
    path.write_bytes(path.read_bytes()[:int(path.stat().st_size * fraction)])
    with pytest.raises(SceneError, match=r"found (no picture that can be read|a damaged picture)") as raised:
        read_image(path)
    assert str(raised.value).startswith(f"{path}: ") and "\n" not in str(raised.value)
    assert capfd.readouterr() == ("", "")


def png(width: int, height: int, rows: bytes = b"") -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


@pytest.mark.parametrize(("width", "height", "message"), [
    (30_000, 30_000, "found no picture that can be read"),
    (100_000, 100_000, "found no picture that can be read"),
    (4000, 4000, "found a damaged picture"),
    (2**31 - 1, 1, "found"),
])
def test_a_file_that_lies_about_its_size_is_one_line(tmp_path: Path, width: int, height: int, message: str) -> None:
    (tmp_path / "a.png").write_bytes(png(width, height, b"\0" * 30))
    with pytest.raises(SceneError, match=message) as raised:
        read_image(tmp_path / "a.png")
    assert "\n" not in str(raised.value)


def test_an_absurd_size_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = store(tmp_path / "a.exr", noise(3, np.float32), full_x=0, full_y=0, full_width=30_000, full_height=30_000)
    with pytest.raises(SceneError, match=r"a\.exr: found a picture of 30000 × 30000, expected at most 268,435,456 texels"):
        read_image(path)
    with pytest.raises(SceneError, match="picture: found a picture of 30000 × 30000"):
        as_pixels(np.broadcast_to(np.uint8(0), (30_000, 30_000, 3)), "picture")


@pytest.mark.parametrize("content", [b"", b"\x89PNG", b"plain text", bytes(1000)])
@pytest.mark.parametrize("suffix", ["png", "jpg", "exr", "hdr", "tif", "gif", "webp", "xyz"])
def test_what_is_no_picture_is_one_line(tmp_path: Path, content: bytes, suffix: str, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / f"a.{suffix}").write_bytes(content)
    with pytest.raises(SceneError, match="found no picture that can be read") as raised:
        read_image(tmp_path / f"a.{suffix}")
    assert "\n" not in str(raised.value)
    assert capfd.readouterr().err == ""


def test_a_wrong_suffix_does_not_matter(tmp_path: Path) -> None:
    (tmp_path / "a.jpg").write_bytes(store(tmp_path / "a.png", noise(3)).read_bytes())
    np.testing.assert_array_equal(read_image(tmp_path / "a.jpg"), noise(3))


def test_a_missing_file_or_a_folder_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"none\.png: found no picture that can be read \(No such file"):
        read_image(tmp_path / "none.png")
    with pytest.raises(SceneError, match="Is a directory"):
        read_image(tmp_path)


def test_standard_error_works_again_afterwards(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    import os

    read_image(store(tmp_path / "a.png", noise(3)))
    os.write(2, b"heard")
    assert capfd.readouterr().err == "heard"


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGB", "RGBA", "CMYK", "F", "I;16"])
def test_pillow_images_become_texels(mode: str) -> None:
    source = PIL.Image.fromarray(noise(3)).convert("L" if mode in ("F", "I;16") else "RGB").convert(mode)
    pixels = as_pixels(source, "picture")
    assert pixels.shape == (12, 20, {"1": 1, "L": 1, "LA": 2, "F": 1, "I;16": 1, "RGBA": 4}.get(mode, 3))
    assert pixels.dtype == (np.float32 if mode in ("F", "I;16") else np.uint8)
    if mode in ("L", "RGB"):
        np.testing.assert_array_equal(pixels.squeeze(), np.asarray(source))
    if mode == "1":
        assert set(np.unique(pixels)) == {0, 255}


def test_a_transparent_palette_keeps_its_alpha() -> None:
    image = PIL.Image.new("P", (2, 1))
    image.putpalette([255, 0, 0, 0, 255, 0])
    image.putpixel((1, 0), 1)
    image.info["transparency"] = 0
    np.testing.assert_array_equal(as_pixels(image, "picture"), [[[255, 0, 0, 0], [0, 255, 0, 255]]])


@pytest.mark.parametrize("array", [np.zeros(4), np.zeros((2, 2, 5)), np.zeros((0, 2, 3)), np.zeros((2, 2), np.int64), np.zeros((1, 2, 2, 3))])
def test_arrays_that_are_no_picture_are_refused(array: np.ndarray) -> None:
    with pytest.raises(SceneError, match="picture: found"):
        as_pixels(array, "picture")


@pytest.mark.skipif(not ASSETS.is_dir(), reason="needs the shared assets beside the checkout")
@pytest.mark.parametrize("name", ["studio.exr", "spiaggia_di_mondello_1k.hdr"])
def test_real_environments_are_read(name: str) -> None:
    pixels = read_image(ASSETS / name)
    assert pixels.shape == (512, 1024, 3) and pixels.dtype == np.float32
    assert pixels.min() > -1e-5 and pixels.max() > 1.0  # lossy compression leaves some just below 0
