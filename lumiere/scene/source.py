"""Reads JSON with comments and trailing commas into a tree that knows its lines and columns."""

from __future__ import annotations

import json
import re
from typing import NoReturn

from lumiere.errors import SceneError
from lumiere.scene.node import MAX_DEPTH, Node, Numbers, Source, printable, quote

_SPACE = r"[ \t\n\r]"
_BLANK = re.compile(rf"(?:{_SPACE}+|//[^\n\r]*|/\*.*?\*/)*", re.DOTALL)
_STRING = re.compile(r'"([^"\\\x00-\x1f]*(?:\\.[^"\\\x00-\x1f]*)*)"', re.DOTALL)
_STRING_END = re.compile(r'(?:[^"\\\x00-\x1f]|\\.)*', re.DOTALL)
_ESCAPE = re.compile(r'\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}|(.))', re.DOTALL)
_SURROGATE = re.compile("[\ud800-\udfff]")
_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(\.[0-9]+)?([eE][-+]?[0-9]+)?")
_WORD = re.compile(r"[^\s,:\[\]{}\"/]+")
_CONSTANTS = {"true": True, "false": False, "null": None}

# Lists of numbers are most of a big file: these match a whole one, and the json module reads it at once.
_NUMBERS = r"\[[-+0-9.eE, \t\n\r]*\]"
_NUMBER_LIST = re.compile(_NUMBERS)
_NUMBER_ROWS = re.compile(rf"\[{_SPACE}*(?:{_NUMBERS}(?:{_SPACE}*,)?{_SPACE}*)+\]")
_TRAILING_COMMA = re.compile(rf"([0-9\]]){_SPACE}*,{_SPACE}*\]")
_LONGEST_INTEGER = 400  # digits; the largest finite float has 309


def parse(data: bytes, name: str) -> Node:
    """The tree of the file called ``name`` with the bytes ``data``.

    Raises SceneError, with line and column, where it is not UTF-8 or not JSON (comments and trailing commas aside), where an object has a
    key twice, or objects and lists are nested deeper than ``MAX_DEPTH``.
    """
    if data.startswith(b"\xef\xbb\xbf"):
        raise SceneError(f"{printable(name)}:1:1: found a byte order mark, expected UTF-8 text without one")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        source = Source(name, data[: error.start].decode("utf-8"))
        line, column = source.position(len(source.text))
        raise SceneError(f"{source.name}:{line}:{column}: found the byte 0x{data[error.start]:02x}, expected UTF-8 text") from None
    return _Parser(name, text).document()


class _Parser:
    """Recursive descent over ``text``; each method takes an offset and returns what it read with the offset behind it."""

    def __init__(self, name: str, text: str) -> None:
        self.text = text
        self.source = Source(name, text)

    def document(self) -> Node:
        pos = self._skip(0, None)
        root, pos = self._value(pos, None, None, 0)
        pos = self._skip(pos, root)
        if pos < len(self.text):
            self._fail(pos, None, "nothing after the top-level value")
        return root

    def _value(self, pos: int, parent: Node | None, key: str | int | None, depth: int) -> tuple[Node, int]:
        node = Node(self.source, pos, parent, key, pos)
        first = self.text[pos : pos + 1]
        if first in ("{", "[") and depth >= MAX_DEPTH:
            raise node.error(f"found objects and lists nested deeper than {MAX_DEPTH}, expected fewer levels")
        if first == '"':
            node.value, pos = self._string(pos, node)
        elif first == "{":
            pos = self._object(node, pos, depth)
        elif first == "[":
            numbers = self._numbers(pos)
            if numbers is None:
                pos = self._list(node, pos, depth)
            else:
                node.value, pos = numbers
        else:
            node.value, pos = self._word(pos, node)
        return node, pos

    def _object(self, node: Node, pos: int, depth: int) -> int:
        members: dict[str, Node] = {}
        node.value = members
        pos = self._skip(pos + 1, node)
        while self.text[pos : pos + 1] != "}":
            if self.text[pos : pos + 1] != '"':
                self._fail(pos, node, "a key in double quotes" if members else "a key in double quotes or '}'")
            key_offset = pos
            key, pos = self._string(pos, node)
            pos = self._skip(pos, node)
            if self.text[pos : pos + 1] != ":":
                self._fail(pos, node, f"':' after the key {quote(key)}")
            child, pos = self._value(self._skip(pos + 1, node), node, key, depth + 1)
            child.key_offset = key_offset
            if key in members:
                first = self.source.position(members[key].key_offset)[0]
                raise child.key_error(f"found a repeated key (first on line {first}), expected each key once")
            members[key] = child
            pos = self._separator(pos, node, "}")
        return pos + 1

    def _list(self, node: Node, pos: int, depth: int) -> int:
        elements: list[Node] = []
        node.value = elements
        pos = self._skip(pos + 1, node)
        while self.text[pos : pos + 1] != "]":
            child, pos = self._value(pos, node, len(elements), depth + 1)
            elements.append(child)
            pos = self._separator(pos, node, "]")
        return pos + 1

    def _separator(self, pos: int, node: Node, end: str) -> int:
        """Behind a member or element: past a comma, or at ``end``."""
        pos = self._skip(pos, node)
        found = self.text[pos : pos + 1]
        if found == ",":
            return self._skip(pos + 1, node)
        if found != end:
            self._fail(pos, node, f"',' or '{end}'")
        return pos

    def _numbers(self, pos: int) -> tuple[Numbers, int] | None:
        """A list of numbers, or of non-empty lists of numbers; None where it is anything else, or has an error to find."""
        match = _NUMBER_LIST.match(self.text, pos) or _NUMBER_ROWS.match(self.text, pos)
        if match is None:
            return None
        text = match.group()
        try:
            try:
                data = json.loads(text)
            except json.JSONDecodeError:
                data = json.loads(_TRAILING_COMMA.sub(r"\1]", text))
        except ValueError:
            return None
        if not data or (isinstance(data[0], list) and not all(data)):
            return None
        return Numbers(data), match.end()

    def _string(self, pos: int, node: Node) -> tuple[str, int]:
        match = _STRING.match(self.text, pos)
        if match is None:
            end = _STRING_END.match(self.text, pos + 1).end()  # type: ignore[union-attr]
            if end < len(self.text) and self.text[end] != "\\":
                raise node.error(f"found the control character U+{ord(self.text[end]):04X} in a string, expected an escape", end)
            raise node.error("found a string without an end, expected '\"'", pos)
        raw = match.group(1)
        if "\\" not in raw:
            return raw, match.end()
        for escape in _ESCAPE.finditer(raw):
            if escape.group(1) is not None:
                raise node.error(f"found the escape {printable(escape.group())}, expected one of \\\" \\\\ \\/ \\b \\f \\n \\r \\t \\uXXXX",
                                 match.start(1) + escape.start())
        string = json.loads(match.group())
        if _SURROGATE.search(string):
            raise node.error("found half a surrogate pair, expected \\uXXXX\\uXXXX of both halves", pos)
        return string, match.end()

    def _word(self, pos: int, node: Node) -> tuple[bool | int | float | None, int]:
        match = _WORD.match(self.text, pos)
        word = match.group() if match else ""
        if word in _CONSTANTS:
            return _CONSTANTS[word], pos + len(word)
        number = _NUMBER.fullmatch(word)
        if number is None:
            numberlike = word[:1].isdigit() or word[:1] in ("-", "+", ".") or word in ("NaN", "Infinity")
            self._fail(pos, node, "a finite number as JSON writes it: no leading zeros, no '+', digits on both sides of '.'" if numberlike
                       else "a value: an object, a list, a string in double quotes, a number, true, false or null")
        whole = number.group(1) is None and number.group(2) is None and len(word) <= _LONGEST_INTEGER
        return (int(word) if whole else float(word)), pos + len(word)

    def _skip(self, pos: int, node: Node | None) -> int:
        """Past white space and comments."""
        pos = _BLANK.match(self.text, pos).end()  # type: ignore[union-attr]
        if self.text.startswith("/*", pos):
            self._fail(pos, node, "'*/' at the comment's end", "a comment without an end")
        return pos

    def _fail(self, pos: int, node: Node | None, expected: str, found: str | None = None) -> NoReturn:
        raise (node or Node(self.source, pos, None, None)).error(f"found {found or self._token(pos)}, expected {expected}", pos)

    def _token(self, pos: int) -> str:
        """What stands at ``pos``, for complaints."""
        if pos == len(self.text):
            return "the end of the file"
        word = _WORD.match(self.text, pos)
        if word is None:
            return "a string" if self.text[pos] == '"' else f"'{printable(self.text[pos])}'"
        return quote(word.group())[1:-1]
