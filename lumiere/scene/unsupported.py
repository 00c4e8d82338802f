"""What the format has and this version does not render yet. A thing that works leaves this table, and nothing else changes."""

from __future__ import annotations

from lumiere.scene.node import Node

ANY = frozenset[str]()
"""Whatever the key holds, unless that is nothing: null, an empty object or list, or 0."""

UNSUPPORTED: dict[tuple[str, str], frozenset[str]] = {
    # (what the object is, its key): values
    ("scene", "media"): ANY,
    ("camera", "shutter"): ANY,
    ("integrator", "type"): frozenset({"bdpt"}),
    ("material", "type"): frozenset({"null"}),
    ("material", "interior"): ANY,
    ("geometry", "type"): frozenset({"group", "instance"}),
}


def refuse_unsupported(node: Node, noun: str) -> None:
    """Raises SceneError where the object ``node``, a ``noun``, has a key that the table lists."""
    for key, child in node.value.items():
        values = UNSUPPORTED.get((noun, key))
        if values is None:
            continue
        empty = child.value is None or (isinstance(child.value, (dict, list)) and not child.value) or (child.is_number and child.value == 0)
        if values is ANY and not empty:
            raise child.error(f"not supported yet: {key}")
        if isinstance(child.value, str) and child.value in values:
            raise child.error(f"not supported yet: {child.value}")
