# SPDX-License-Identifier: GPL-3.0-or-later
"""The codes of units in field data, and how often each is there: to see what `names` has to say."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ..base.text import no_step
from ..base.units import MODEL_UNIT
from ..settings.data_files import Boreholes, MapFile, ObservationFile
from ..settings.dips import DipFile
from .borehole_input import read_repaired
from .object_input import is_object_file
from .tables.dips import DIPS, NAMED
from .tables.hole_tables import OBSERVED, Row, rows
from .tables.table_layout import is_number
from .unit_polygons import read_unit_polygons

FieldData = Boreholes | ObservationFile | DipFile | MapFile


@dataclass(frozen=True)
class CodeCount:
    """code: as the tables have it. holes: in how many boreholes it is. rows: of tables, and polygons of maps.
    length: of all its intervals along holes, in model units."""

    code: str
    holes: int
    rows: int
    length: float


def count_codes(*data: FieldData, units: str = MODEL_UNIT) -> list[CodeCount]:
    """The codes of surfaces and blocks in boreholes, observations, dips and maps, in the order in which they
    come first. units: of the model. Raises InputRefused naming file and line."""
    holes: dict[str, set[str]] = {}
    counted: dict[str, int] = {}
    lengths: dict[str, float] = {}
    for source in data:
        for code, hole, length in _codes(source, units):
            if code:
                holes.setdefault(code, set()).update([hole] if hole else [])
                counted[code] = counted.get(code, 0) + 1
                lengths[code] = lengths.get(code, 0.0) + length
    return [CodeCount(code, len(holes[code]), counted[code], lengths[code]) for code in counted]


def _codes(source: FieldData, units: str) -> Iterator[tuple[str, str, float]]:
    """(code, hole or "", length) of each row."""
    if isinstance(source, MapFile):
        polygons, _, _ = read_unit_polygons(source, units)
        yield from ((polygon.unit, "", 0.0) for polygon in polygons)
    elif isinstance(source, ObservationFile):
        for row in rows(source, Path(source.file), OBSERVED, ("block",), no_step):
            yield _text(row, "block"), _text(row, "hole"), 0.0
    elif isinstance(source, DipFile):
        for row in rows(source, Path(source.file), {**DIPS, **NAMED}, (), no_step):
            yield next((_text(row, key) for key in NAMED if row.has(key)), ""), "", 0.0
    else:
        tables = read_repaired(source, units)
        height = float(tables.scale(units)[2])
        for row in tables.intervals or ():
            yield _text(row, "block"), _text(row, "hole"), _length(row) * height
        of_objects = any(is_object_file(file) for file in source.files)  # whose picks are of intervals
        for row in () if of_objects and tables.intervals else tables.picks or ():
            yield _text(row, "surface"), _text(row, "hole"), 0.0


def _text(row: Row, column: str) -> str:
    return row.text(column) if row.has(column) else ""


def _length(row: Row) -> float:
    """Of an interval; 0 where one of its depths is not known."""
    if not all(row.has(key) and is_number(row.text(key), row.decimal) for key in ("from", "to")):
        return 0.0
    length = row.number("to") - row.number("from")
    return max(length, 0.0)
