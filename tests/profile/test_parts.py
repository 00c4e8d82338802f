"""The parts of a profile that need no device."""

from __future__ import annotations

from pathlib import Path

import pytest

from lumiere.cli.main import main
from lumiere.compile.features import Features
from lumiere.profile.bins import bins
from lumiere.profile.compiler import registers
from lumiere.profile.observe import Launch
from lumiere.profile.report import number
from lumiere.profile.summary import gaps
from lumiere.profile.traffic import Traffic, active_lines, path_traffic, queue_bytes
from lumiere.wavefront.policy import Policy

FEATURES = Features(shapes={}, bsdfs={"lambert": ()}, camera="perspective", sampler="sobol")


def test_gaps_are_between_the_end_and_the_next_start() -> None:
    launches = [Launch("generate", 0, 0, 0.0, 1.0), Launch("extend", 0, 0, 1.5, 1.0), Launch("connect", 0, 0, 2.5, 0.5)]
    assert gaps(launches) == [0.0, 0.5, 0.0]


def test_only_what_the_macros_leave_counts() -> None:
    text = "#define A\n#ifdef A\none\n#else\ntwo\n#endif\n#ifndef A\nthree\n#ifdef A\nfour\n#endif\n#endif\n#undef A\n#ifdef A\nfive\n#endif\nsix"
    assert [line for line in active_lines(text) if not line.startswith("#")] == ["one", "six"]


def test_a_field_counts_once_a_way() -> None:
    text = ("static inline float3 path_get_origin(const path_t *path, uint slot) { return 0; }\n"
            "x = path_get_direction(path, slot) + path_get_direction(&path, slot);\n"
            "path_set_direction(path, slot, x); path_set_depth(path, slot, 1u);\n"
            "path_set_depth_lanes(path, first, mask, path_get_direction_lanes(path, first));\n"
            "#ifdef PATH_BSDF_PDF\npath_set_bsdf_pdf(path, slot, 0.0f);\n#endif\n")
    assert path_traffic("shade", text, FEATURES) == Traffic(read=12, written=16)
    assert path_traffic("connect", text + "sample_add_radiance(&scene, x);\n", FEATURES) == Traffic(read=12, written=16, samples=24)
    assert path_traffic("accumulate", "", FEATURES) == Traffic(read=0, written=0, samples=12)


def test_lists_move_entries_and_tags_move_every_slot() -> None:
    lists, tags = (Policy(compacted, 64, 1024, 1024, 2) for compacted in (True, False))
    assert queue_bytes(lists, "extend", items=10, given=8, slots=64) == 4 * (10 + 10)  # two paths have ended, and their slots are idle
    assert queue_bytes(lists, "connect", items=10, given=0, slots=64) == 4 * 10
    assert queue_bytes(tags, "extend", items=10, given=8, slots=1024) == 4 * (1024 + 10)
    assert queue_bytes(tags, "generate", items=10, given=10, slots=1024) == 4 * (2 * 1024 + 10)
    assert queue_bytes(lists, "accumulate", items=10, given=0, slots=64) == 0


def test_registers_are_read_from_the_log() -> None:
    log = "ptxas info    : 0 bytes gmem\nptxas info    : Compiling entry function 'extend' for 'sm_90'\n"
    assert registers(log + "ptxas info    : Used 72 registers, 640 bytes cmem[0]\n") == 72
    assert registers(log) is None


def test_bins_are_means_of_counts_and_sums_of_times() -> None:
    rounds = [{"batch": 0, "round": i, "paths": 10 * i, "items": {"generate": i}, "seconds": {"generate": 1.0}} for i in range(5)]
    rounds.append({"batch": 0, "round": 5, "paths": 0, "items": {"accumulate": 9}, "seconds": {"accumulate": 1.0}})
    parts = bins(rounds, ["generate"], 3)
    assert [part.label for part in parts] == ["0–1", "2–3", "4"]
    assert [part.paths for part in parts] == [5.0, 25.0, 40.0]
    assert [part.seconds["generate"] for part in parts] == [2.0, 2.0, 1.0]
    assert parts[1].items["generate"] == 2.5


@pytest.mark.parametrize(("value", "text"), [(None, "–"), (0.0, "0"), (1234567.0, "1,234,567"), (12.34, "12.3"), (0.5, "0.5"), (1e-5, "1.0e-05")])
def test_numbers_are_short(value: float | None, text: str) -> None:
    assert number(value) == text


@pytest.mark.parametrize("text", ["not json", "[]", '{"format": "another"}'])
def test_comparing_refuses_other_files(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.json"
    path.write_text(text, encoding="utf-8")
    assert main(["profile", "--compare", str(path), str(path)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"lumiere: {path}: found ") and error.count("\n") == 1


@pytest.mark.parametrize("arguments", [["profile"], ["profile", "a.json", "--compare", "b.json", "c.json"]])
def test_either_a_scene_or_two_profiles(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    assert "expected one of them" in capsys.readouterr().err
