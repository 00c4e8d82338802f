"""JSON with positions: what is accepted, what is not, and where the complaint points."""

from __future__ import annotations

import json
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lumiere.errors import SceneError
from lumiere.scene.node import MAX_DEPTH, Node, Numbers, from_python
from lumiere.scene.source import parse


def plain(node: Node) -> object:
    """The document as the json module would give it."""
    if isinstance(node.value, dict):
        return {key: plain(child) for key, child in node.value.items()}
    return [plain(child) for child in node.items()] if node.is_list else node.value


def complaint(data: bytes) -> str:
    with pytest.raises(SceneError) as caught:
        parse(data, "s.json")
    text = str(caught.value)
    assert len(text.splitlines()) == 1
    return text


ACCEPTED = {
    "comments": ('// one\n{/* two\n lines */"a": 1 // three\n, "b"/**/:[1,/*x*/2]}\r// end', {"a": 1, "b": [1, 2]}),
    "comment signs in a string": ('{"a": "/* not // one */"}', {"a": "/* not // one */"}),
    "trailing commas": ('{"a": [1, 2, ], "b": {"c": [[1, 2,], [3,],], }, }', {"a": [1, 2], "b": {"c": [[1, 2], [3]]}}),
    "empty": ('{"a": [], "b": {}, "c": [[], [1]], "d": ""}', {"a": [], "b": {}, "c": [[], [1]], "d": ""}),
    "numbers": ("[0, -0, 1.5e3, -2E-2, 1e+2, 0.25, 12345678901234567890]", [0, 0, 1500.0, -0.02, 100.0, 0.25, 12345678901234567890]),
    "constants": ("[true, false, null]", [True, False, None]),
    "escapes": (r'"\" \\ \/ \b \f \n \r \t \u00e9 \ud83d\ude00"', '" \\ / \b \f \n \r \t é 😀'),
    "mixed": ('[1, [2, "x"], [3]]', [1, [2, "x"], [3]]),
    "not nested too deep": ("[" * MAX_DEPTH + "]" * MAX_DEPTH, json.loads("[" * MAX_DEPTH + "]" * MAX_DEPTH)),
}


@pytest.mark.parametrize(("text", "value"), ACCEPTED.values(), ids=ACCEPTED)
def test_accepts(text: str, value: object) -> None:
    assert plain(parse(text.encode(), "s.json")) == value


VALUE = "expected a value: an object, a list, a string in double quotes, a number, true, false or null"
NUMBER = "expected a finite number as JSON writes it: no leading zeros, no '+', digits on both sides of '.'"
DEPTH = f"found objects and lists nested deeper than {MAX_DEPTH}, expected fewer levels"
REJECTED = {  # text with § in front of the culprit → path, complaint
    "nothing": ("§", "", f"found the end of the file, {VALUE}"),
    "only a comment": ("// nothing\n§", "", f"found the end of the file, {VALUE}"),
    "open object": ('{"a": 1§', "", "found the end of the file, expected ',' or '}'"),
    "open list": ('{"a": [1, 2§', "a", "found the end of the file, expected ',' or ']'"),
    "no comma": ('{"a": 1\n   §"b": 2}', "", "found a string, expected ',' or '}'"),
    "no colon": ('{"a" §1}', "", "found 1, expected ':' after the key \"a\""),
    "no value": ('{"a": §}', "a", f"found '}}', {VALUE}"),
    "two commas": ("[1, §, 2]", "[1]", f"found ',', {VALUE}"),
    "a comma alone": ("[§,]", "[0]", f"found ',', {VALUE}"),
    "a comma alone in an object": ("{§,}", "", "found ',', expected a key in double quotes or '}'"),
    "single quotes": ("{§'a': 1}", "", "found 'a', expected a key in double quotes or '}'"),
    "no quotes": ('{"a": 1, §b: 2}', "", "found b, expected a key in double quotes"),
    "unknown word": ('{"a": §nul}', "a", f"found nul, {VALUE}"),
    "upper case": ('{"a": §True}', "a", f"found True, {VALUE}"),
    "NaN": ('{"a": [0, §NaN]}', "a[1]", f"found NaN, {NUMBER}"),
    "Infinity": ('{"a": §Infinity}', "a", f"found Infinity, {NUMBER}"),
    "-Infinity": ('{"a": §-Infinity}', "a", f"found -Infinity, {NUMBER}"),
    "leading zero": ('{"a": [1, 2,\n§01]}', "a[2]", f"found 01, {NUMBER}"),
    "plus": ('{"a": §+1}', "a", f"found +1, {NUMBER}"),
    "no digit behind the point": ('{"a": §1.}', "a", f"found 1., {NUMBER}"),
    "no digit before the point": ('{"a": §.5}', "a", f"found .5, {NUMBER}"),
    "no digit in the exponent": ('{"a": §1e}', "a", f"found 1e, {NUMBER}"),
    "hexadecimal": ('{"a": §0x10}', "a", f"found 0x10, {NUMBER}"),
    "digit groups": ('{"a": §1_000}', "a", f"found 1_000, {NUMBER}"),
    "number without end": ('{"a": [[1, 2], [3, §-]]}', "a[1][1]", f"found -, {NUMBER}"),
    "no comma between numbers": ("[1 §2]", "", "found 2, expected ',' or ']'"),
    "repeated key": ('{"a": {"b": 1,\n "c": 2, §"b": 3}}', "a.b", "found a repeated key (first on line 1), expected each key once"),
    "repeated by an escape": (r'{"b": 1, §"\u0062": 3}', "b", "found a repeated key (first on line 1), expected each key once"),
    "unknown escape": (r'{"a": "x§\q"}', "a", "found the escape \\q, expected one of"),
    "short escape": (r'{"a": "é§\u12"}', "a", "found the escape \\u, expected one of"),
    "escape in a key": (r'{"§\x61": 1}', "", "found the escape \\x, expected one of"),
    "half a surrogate pair": (r'{"a": §"\ud800"}', "a", "found half a surrogate pair"),
    "line end in a string": ('{"a": "b§\nc"}', "a", "found the control character U+000A in a string, expected an escape"),
    "open string": ('{"a": §"b}', "a", "found a string without an end"),
    "open string with an escape": ('{"a": §"b\\', "a", "found a string without an end"),
    "open comment": ('{"a": 1} §/* ', "", "found a comment without an end, expected '*/'"),
    "stray slash": ('{"a": §/ 1}', "a", f"found '/', {VALUE}"),
    "hash comment": ('{§# x\n"a": 1}', "", "found #, expected a key in double quotes or '}'"),
    "more than one value": ("{} §{}", "", "found '{', expected nothing after the top-level value"),
    "vertical tab": ('{"a":§\x0b1}', "a", "found '\\u000b', "),
    "no-break space": ('{"a":§\u00a01}', "a", "found '\\u00a0', "),
    "NUL": ("§\0", "", "found \\u0000, "),
    "nested lists": ("[" * MAX_DEPTH + "§" + "[" * 100_000, "[0]" * MAX_DEPTH, DEPTH),
    "nested objects": ('{"a":' * MAX_DEPTH + "§" + '{"a":' * 100_000, ".".join("a" * MAX_DEPTH), DEPTH),
    "after characters of more than one byte": ('{"é😀": §x}', '["é😀"]', f"found x, {VALUE}"),
    "after CR LF": ('{"a": 1,\r\n\r\n  "b": §x}', "b", f"found x, {VALUE}"),
    "key with a line end": ('{"a\\nb": §x}', '["a\\nb"]', f"found x, {VALUE}"),
    "a long word": ("§" + "x" * 1000, "", f"found {'x' * 60}…, {VALUE}"),
}


@pytest.mark.parametrize(("marked", "path", "words"), REJECTED.values(), ids=REJECTED)
def test_rejects(marked: str, path: str, words: str) -> None:
    before = marked[: marked.index("§")].replace("\r\n", "\n")
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    where = f"s.json:{line}:{column}: {path}: " if path else f"s.json:{line}:{column}: "
    assert complaint(marked.replace("§", "").encode()).startswith(where + words)


@pytest.mark.parametrize(("data", "expected"), [
    (b"\xef\xbb\xbf{}", "s.json:1:1: found a byte order mark, expected UTF-8 text without one"),
    ("{}".encode("utf-16"), "s.json:1:1: found the byte 0xff, expected UTF-8 text"),
    (b'{"a":\n "\xc3\xa9\xff"}', "s.json:2:4: found the byte 0xff, expected UTF-8 text"),
    (b'{"a": "\xed\xa0\x80"}', "s.json:1:8: found the byte 0xed, expected UTF-8 text"),
], ids=["byte order mark", "UTF-16", "stray byte", "encoded surrogate"])
def test_rejects_bytes(data: bytes, expected: str) -> None:
    assert complaint(data) == expected


def test_the_file_name_stays_on_one_line() -> None:
    with pytest.raises(SceneError, match=r"^a\\nb\.json:1:1: "):
        parse(b"", "a\nb.json")


def test_lists_of_numbers_are_read_at_once() -> None:
    """A big mesh must not become a node a number."""
    node = parse(b'{"flat": [1, 2.5, -3e2],\n "rows": [[1, 2],\n [3, 4],]}', "s.json")
    flat, rows = node.value["flat"], node.value["rows"]
    assert flat.value == Numbers([1, 2.5, -300.0])
    assert rows.value == Numbers([[1, 2], [3, 4]])
    assert from_python({"rows": ((1, 2), [3, 4])}).value["rows"].value == Numbers(((1, 2), [3, 4]))
    assert flat.item(2).place() == "s.json:1:19: flat[2]"
    assert rows.item(1).item(1).place() == "s.json:3:6: rows[1][1]"


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(st.characters(codec="utf-8")),
    lambda children: st.lists(children, max_size=5) | st.dictionaries(st.text(st.characters(codec="utf-8"), max_size=5), children, max_size=5),
    max_leaves=30)


def write(value: object, rng: random.Random) -> str:
    """JSON with white space, comments and trailing commas strewn in."""
    def blank() -> str:
        return rng.choice(["", "", "", " ", "\n\t", "//é\n", "/* , ] */", "\r\n"])

    if isinstance(value, dict):
        parts = [f"{blank()}{json.dumps(key)}{blank()}:{write(child, rng)}" for key, child in value.items()]
        left, right = "{}"
    elif isinstance(value, list):
        parts = [write(child, rng) for child in value]
        left, right = "[]"
    else:
        return blank() + json.dumps(value, ensure_ascii=rng.random() < 0.5) + blank()
    return blank() + left + ",".join(parts) + ("," if parts and rng.random() < 0.3 else "") + blank() + right + blank()


@settings(max_examples=150, deadline=None, derandomize=True)
@given(JSON, st.integers(0, 2**32))
def test_reads_what_json_means(value: object, seed: int) -> None:
    assert plain(parse(write(value, random.Random(seed)).encode(), "s.json")) == value
    assert plain(from_python(value)) == value


@settings(max_examples=100, deadline=None, derandomize=True)
@given(JSON, st.integers(0, 2**32))
def test_every_node_knows_where_it_stands(value: object, seed: int) -> None:
    text = write(value, random.Random(seed))
    pending = [parse(text.encode(), "s.json")]
    while pending:
        node = pending.pop()
        first = text[node.offset]
        if isinstance(node.value, dict):
            assert first == "{"
            pending += node.value.values()
            for key, child in node.value.items():
                assert text.startswith((json.dumps(key), json.dumps(key, ensure_ascii=False)), child.key_offset)
        elif node.is_list:
            assert first == "["
            pending += node.items()
        else:
            assert text.startswith((json.dumps(node.value), json.dumps(node.value, ensure_ascii=False)), node.offset)


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.binary(max_size=40) | st.text("{}[]\",:\\/*-+.019eEuntf \n", max_size=40).map(str.encode))
def test_any_bytes_parse_or_are_refused(data: bytes) -> None:
    try:
        parse(data, "s.json")
    except SceneError as error:
        assert len(str(error).splitlines()) == 1
