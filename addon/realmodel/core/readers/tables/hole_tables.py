# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of tables of boreholes and of dips, with columns found by their usual names."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step
from ...base.units import other_units
from .points import TextTable, open_table
from .table_layout import Expected, fields, is_number, plain_name

_HOLE = ("hole", "hole_id", "holeid", "bhid", "borehole", "well", "well_id", "name", "id")
# In the order in which they are looked for: a column has one meaning in a table.
PICKS = {
    "hole": _HOLE,
    "x": ("x", "easting", "east"),
    "y": ("y", "northing", "north"),
    "z": ("z", "collar", "elevation", "elev", "altitude", "rl", "kb", "height"),
    "surface": ("surface", "horizon", "top", "marker", "formation", "unit", "pick"),
    "depth": ("depth", "md", "tvd", "from"),
    "elevation": ("elevation", "elev", "z", "altitude", "rl", "height"),
}
DIRECTIONS = {
    "azimuth": ("azimuth", "azi", "azim", "azm", "az", "bearing", "brg"),
    "dip": ("dip", "plunge"),
    "inclination": ("inclination", "incl", "inc", "deviation"),
}
SURVEY = {
    "hole": _HOLE,
    "depth": ("depth", "md", "measured_depth", "at", "distance", "dist", "survey_depth"),
    **DIRECTIONS,
}
COLLARS = {
    **PICKS,
    **DIRECTIONS,
    "end": (
        *("end", "eoh", "end_of_hole", "end_depth", "total_depth", "totaldepth", "td", "max_depth"),
        *("maxdepth", "final_depth", "hole_depth", "hole_length", "length"),
    ),
    "use": ("use",),
}
_BLOCK = (
    *(
        "block",
        "unit",
        "lithology",
        "litho",
        "lith",
        "lith_code",
        "lithcode",
        "rock",
        "rock_type",
        "rocktype",
    ),
    *("formation", "strat", "stratigraphy", "geology", "geol", "code", "layer"),
)
INTERVALS = {
    "hole": _HOLE,
    **{axis: PICKS[axis] for axis in "xyz"},
    "from": (
        *("from", "depth_from", "from_depth", "depthfrom", "from_m", "start", "begin", "top", "top_depth"),
        *("depth_top", "md", "tvd"),
    ),
    "to": (
        *("to", "depth_to", "to_depth", "depthto", "to_m", "end", "bottom", "base", "bottom_depth"),
        *("depth_bottom", "base_depth"),
    ),
    "block": _BLOCK,
    **DIRECTIONS,
    "use": ("use",),
}
OBSERVED = {
    "x": PICKS["x"],
    "y": PICKS["y"],
    "z": ("z", "elevation", "elev", "altitude", "rl", "height"),
    "block": _BLOCK,
    "hole": _HOLE[:-2],  # names and ids are of the places
    "depth": ("depth", "md"),
    "use": ("use",),
    "on": ("seen_on",),
    "error": ("height_error",),
}
_OFF = frozenset(("0", "no", "false", "off"))  # in the column `use` of rows that are switched off
# What stands in a column where there is no value; in small letters.
NO_VALUE = frozenset(("", "-", "--", "na", "n/a", "nan", "nr", "null", "none", "absent", "?"))
_STEP = 5000  # rows
_MOST_TURNED = 720.0  # degrees
_LENGTHS = frozenset(("x", "y", "z", "depth", "elevation", "from", "to", "end"))

Columns = Mapping[str, Sequence[str]]  # possible names of a column, by its meaning


class Reading(Protocol):
    """How tables are read: of Boreholes, of an ObservationFile, or of a DipFile."""

    @property
    def columns(self) -> Mapping: ...

    @property
    def separator(self) -> str | None: ...

    @property
    def decimal(self) -> str | None: ...

    @property
    def units(self) -> str | Mapping | None: ...


@dataclass(frozen=True)
class Header:
    """names: of the columns as they are written, none without a header. line: its number, 1 without one.
    columns: the numbers of the columns from 0, by their meaning."""

    file: Path
    names: Sequence[str]
    line: int
    columns: dict[str, int]


@dataclass(frozen=True)
class Row:
    header: Header
    line: int
    entries: list[str]
    decimal: str = "."

    @property
    def file(self) -> Path:
        return self.header.file

    @property
    def columns(self) -> dict[str, int]:
        return self.header.columns

    def refuse(self, what: str, advice: str | None = None) -> InputRefused:
        return InputRefused(what, file=self.file, line=self.line, advice=advice)

    def with_values(self, **values: float | str) -> Row:
        """The same with other values in some of its columns, by their meaning."""
        entries = list(self.entries)
        for column, value in values.items():
            text = value if isinstance(value, str) else repr(float(value)).replace(".", self.decimal)
            entries[self.columns[column.strip("_")]] = text
        return replace(self, entries=entries)

    def text(self, column: str) -> str:
        at = self.columns[column]
        if at >= len(self.entries):
            raise self.refuse(f"{at + 1} values are needed, there are {len(self.entries)}")
        return self.entries[at]

    def has(self, column: str) -> bool:
        """Whether there is such a column, with a value in this row."""
        at = self.columns.get(column, len(self.entries))
        return at < len(self.entries) and self.entries[at].lower() not in NO_VALUE

    @property
    def is_used(self) -> bool:
        """Whether the row is not switched off in its column `use`."""
        return not self.has("use") or self.entries[self.columns["use"]].lower() not in _OFF

    def called(self, column: str) -> str:
        """The name of a column in the header, in small letters; empty without a header."""
        names, at = self.header.names, self.columns[column]
        return plain_name(names[at]) if at < len(names) else ""

    def number(self, column: str, advice: str | None = None) -> float:
        entry = self.text(column)
        if not is_number(entry, self.decimal):
            raise self.refuse(f"{column} is not a number: '{entry:.40}'", advice)
        value = float(entry.replace(",", "."))
        if not np.isfinite(value):
            raise self.refuse(f"{column} is {entry}, not a finite number")
        return value

    def azimuth(self, column: str) -> float:
        """An angle in plan, degrees: also one beyond 360, but none that stands for no value."""
        value = self.number(column)
        if abs(value) > _MOST_TURNED:
            raise self.refuse(f"{column} is {value:g}", "it is in degrees clockwise from north")
        return value


def rows(given: Reading, file: Path, known: Columns, needed: Sequence[str], step: Step) -> Iterator[Row]:
    """The rows of a table, with those of the known columns that it has. Raises InputRefused where it lacks
    one that is needed."""
    table = _opened(given, file, known)
    layout = table.layout
    header = Header(file, layout.names or (), layout.name_line or 1, _columns(given, table, known, needed))
    separator = layout.separator
    body = table.raw[layout.body :].decode(table.encoding)
    decimal = given.decimal or "."
    if given.decimal is None and separator != ",":
        entries = list(_parts(body, separator))
        has_points = any("." in entry and is_number(entry) for entry in entries)
        has_commas = any("," in entry and is_number(entry, ",") for entry in entries)
        decimal = "," if has_commas and not has_points else "."
    total = max(body.count("\n"), 1)
    for number, line in enumerate(body.split("\n")):
        if number % _STEP == 0:
            step(number / total)
        stripped = line.strip()
        if not stripped or stripped.startswith("#"):
            continue
        yield Row(header, layout.body_line + number, layout.fields(line.rstrip("\r")), decimal)


def other_units_in(given: Reading, file: Path, known: Columns, model_unit: str) -> list[str]:
    """The warnings about units in the header of a table, other than those in which it is read."""
    table = _opened(given, file, known)
    names, units = table.layout.names or (), given.units
    units = units if isinstance(units, Mapping) else {"xy": units, "z": units}
    column_units = {
        names[at]: units.get("xy" if meaning in ("x", "y") else "z")
        for meaning, at in _columns(given, table, known, ()).items()
        if meaning in _LENGTHS and at < len(names)
    }
    return other_units(file, column_units, model_unit)


def columns_in(given: Reading, file: Path, known: Columns) -> dict[str, str]:
    """The known columns that a table has, by their meaning: their names in the header, in small letters.
    Raises InputRefused if it is not a table."""
    table = _opened(given, file, known)
    names = [plain_name(name) for name in table.layout.names or ()]
    columns = _columns(given, table, known, ())
    return {meaning: names[at] if at < len(names) else "" for meaning, at in columns.items()}


def _opened(reading: Reading, file: Path, meanings: Columns) -> TextTable:
    names = {column.lower() for column in reading.columns.values() if isinstance(column, str)}
    names.update(alias for aliases in meanings.values() for alias in aliases)
    return open_table(file, Expected(reading.separator, (), names, 1, 2))


def _parts(body: str, separator: str) -> Iterator[str]:
    """Entries of the first lines."""
    for line in body[:20_000].split("\n"):
        yield from fields(line, separator)


def normalized_name(name: str) -> str:
    """A name, for comparing, in small letters, and with one sign for the spaces, hyphens and underscores that
    may part its words."""
    return re.sub(r"[\s_-]+", "_", name.strip().lower())


def _columns(reading: Reading, table: TextTable, meanings: Columns, needed: Sequence[str]) -> dict[str, int]:
    """The numbers of the columns of a table, by their meaning."""
    written = table.layout.names or ()
    names = [normalized_name(plain_name(name)) for name in written]
    as_written = [name.strip().lower() for name in written]
    columns: dict[str, int] = {}
    for column, called in reading.columns.items():  # first, so that no other column takes what they name
        if column not in meanings:
            continue
        if isinstance(called, int):
            columns[column] = called - 1
        elif called.strip().lower() in as_written:
            columns[column] = table.column(called)
        elif normalized_name(called) in names:
            columns[column] = names.index(normalized_name(called))
    for column, aliases in meanings.items():
        # depths of picks are often called otherwise than a survey's
        if column in columns or (reading.columns.get(column) is not None and meanings is not SURVEY):
            continue
        at = next(
            (names.index(normalized_name(alias)) for alias in aliases if normalized_name(alias) in names),
            None,
        )
        if at is not None and at not in columns.values():
            columns[column] = at
    for column in needed:
        if column not in columns:
            called = reading.columns.get(column)
            what = f"the header has no column {called or column}"
            advice = f'name it: columns = {{ {column} = "..." }}'
            raise InputRefused(what, file=table.file, line=table.layout.name_line or 1, advice=advice)
    return columns
