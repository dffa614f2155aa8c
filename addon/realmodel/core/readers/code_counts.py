# SPDX-License-Identifier: GPL-3.0-or-later
"""The codes of units in field data, and how often each is there: to see what `names` has to say."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ..base.errors import InputRefused
from ..base.text import no_step, read_text
from ..base.units import MODEL_UNIT
from ..settings.data_files import Boreholes, MapFile, ObservationFile
from ..settings.dips import DipFile
from .borehole_input import read_repaired
from .object_input import is_object_file
from .tables.dialects.workbook import is_workbook, sheet_text
from .tables.dips import DIPS, NAMED
from .tables.hole_tables import OBSERVED, Row, column_key, rows
from .tables.table_layout import fields, is_number
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


_OF_CODES = frozenset(
    ("code", "codes", "lithcode", "lithologycode", "rockcode", "unitcode", "legendcode", "from")
)
_OF_UNITS = frozenset(
    ("unit", "name", "meaning", "means", "block", "surface", "formation", "group", "lithology", "rock")
)


def read_names(file: str | Path) -> dict[str, str]:
    """The meanings of codes in a table of two columns, code and unit, or of more where the header names these
    two; a unit that is empty: the code means nothing. Raises InputRefused naming file and line."""
    file = Path(file)
    text = sheet_text(file, None, lambda _cells: True).decode() if is_workbook(file) else read_text(file)
    lines = [(n, line) for n, line in enumerate(text.split("\n"), 1) if line.strip(" \t\r,;|")]
    lines = [(n, line.rstrip("\r")) for n, line in lines if not line.startswith("#")]
    if not lines:
        raise InputRefused("there are no names in it", file=file)
    separator = next((sign for sign in ";\t|,=" if sign in lines[0][1]), ",")
    keys = [column_key(name) for name in fields(lines[0][1], separator)]
    of_code, of_unit = (
        next((n for n, k in enumerate(keys) if k in known), None) for known in (_OF_CODES, _OF_UNITS)
    )
    if of_code is None or of_unit is None:
        of_code, of_unit = 0, 1
    else:
        lines = lines[1:]
    names: dict[str, str] = {}
    for n, line in lines:
        entries = fields(line, separator)
        if len(entries) <= max(of_code, of_unit) or not entries[of_code]:
            raise InputRefused(
                "a code and a unit are needed", file=file, line=n, advice="write SST,Sandstone"
            )
        code, unit = entries[of_code], entries[of_unit]
        if names.setdefault(code, unit) != unit:
            raise InputRefused(f"'{code}' means '{names[code]}' and '{unit}'", file=file, line=n)
    return names


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
