"""Mixes → rows of the object table: an object whose material is a mix gets a row for each part, and extend chooses between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lumiere.bsdf import Material
from lumiere.bsdf.mix import Mix
from lumiere.compile.geometry import Object

NO_ROW = 0xFFFFFFFF


@dataclass
class Row:
    """A row of the object table. ``number`` is that of ``object``; where ``material`` is a mix, ``a`` and ``b`` are its parts' rows."""

    object: Object
    number: int
    material: Material
    normal_map: Any
    bump_map: Any
    bump_scale: float
    a: int = NO_ROW
    b: int = NO_ROW

    @property
    def mixed(self) -> bool:
        """Chosen between, and never shaded."""
        return isinstance(self.material, Mix)


def rows_of(objects: list[Object]) -> list[Row]:
    """A row for each object, in their order, and behind them the rows of their parts."""
    rows = [Row(o, i, o.material, o.material.normal_map, o.material.bump_map, o.material.bump_scale) for i, o in enumerate(objects)]
    done = 0
    while done < len(rows):
        row = rows[done]
        if isinstance(row.material, Mix):
            row.a, row.b = len(rows), len(rows) + 1
            rows += [_part(row, part) for part in (row.material.a, row.material.b) if part is not None]
        done += 1
    return rows


def _part(row: Row, part: Material) -> Row:
    bumped = part if part.bump_map is not None else row
    normal_map = row.normal_map if part.normal_map is None else part.normal_map
    return Row(row.object, row.number, part, normal_map, bumped.bump_map, bumped.bump_scale)
