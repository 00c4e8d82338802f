"""The record of how a picture was made, as JSON."""

from __future__ import annotations

import json
import os
from typing import Any

from lumiere.film.atomic import replacing


def _plain(value: Any) -> Any:
    """What JSON lacks, as what it has: numpy's scalars and arrays as numbers and lists, the rest as text."""
    return value.tolist() if hasattr(value, "tolist") else str(value)


def record_json(record: dict[str, Any], indent: int | None = None) -> str:
    """``record`` as JSON text."""
    return json.dumps(record, indent=indent, default=_plain, ensure_ascii=False)


def write_record(record: dict[str, Any], path: str | os.PathLike[str]) -> None:
    """Writes ``record`` as indented JSON, whole or not at all. Raises LumiereError where that fails."""
    with replacing(path) as temporary:
        temporary.write_text(record_json(record, indent=2) + "\n", encoding="utf-8")
