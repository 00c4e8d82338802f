"""What is left of a program when its #ifs are resolved: enough of the C preprocessor for our own sources."""

from __future__ import annotations

import re

_DIRECTIVE = re.compile(r"^\s*#\s*(ifdef|ifndef|if|elif|else|endif|define|undef)\b\s*(.*)$")
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def _holds(expression: str, macros: dict[str, str]) -> bool:
    expression = re.sub(r"defined\s*\(\s*(\w+)\s*\)|defined\s+(\w+)", lambda m: str(int((m[1] or m[2]) in macros)), expression)
    expression = re.sub(r"[A-Za-z_]\w*", lambda m: macros.get(m[0], "0"), expression)
    expression = re.sub(r"(\d)u\b", r"\1", expression).replace("&&", " and ").replace("||", " or ")
    return bool(eval(re.sub(r"!(?!=)", " not ", expression), {"__builtins__": {}}))


def active_lines(text: str) -> str:
    """The lines that a compiler sees, without comments. Macros are not expanded; their definitions stay, of function-like ones as they stand."""
    text = _COMMENT.sub("", text).replace("\\\n", " ")
    macros: dict[str, str] = {}
    open_ifs: list[tuple[bool, bool, bool]] = []  # is the branch active, has one been, is what is around
    lines = []
    for line in text.splitlines():
        directive = _DIRECTIVE.match(line)
        active = all(branch for branch, _, _ in open_ifs)
        if directive is None or directive[1] in ("define", "undef"):
            if active:
                lines.append(line)
                if directive:
                    name, _, value = directive[2].partition(" ")
                    if directive[1] == "define":
                        macros[name.partition("(")[0]] = value.strip()
                    else:
                        macros.pop(name.strip(), None)
            continue
        word, rest = directive[1], directive[2]
        if word in ("if", "ifdef", "ifndef"):
            value = {"if": lambda r=rest: _holds(r, macros), "ifdef": lambda r=rest: r.strip() in macros, "ifndef": lambda r=rest: r.strip() not in macros}
            branch = active and value[word]()
            open_ifs.append((branch, branch, active))
        elif word == "endif":
            open_ifs.pop()
        else:
            _, taken, around = open_ifs.pop()
            branch = around and not taken and (word == "else" or _holds(rest, macros))
            open_ifs.append((branch, taken or branch, around))
    return "\n".join(lines)
