# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of surfaces from tables of boreholes: collars, and the depths at which surfaces were met."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..boreholes import Boreholes
from ..errors import InputRefused, number_list
from ..units import MODEL_UNIT, factor
from .points import Table, open_table
from .table_layout import fields, is_number, plain_name
from .text import Step, no_step

_ALIASES = {
    "hole": ("hole", "hole_id", "holeid", "bhid", "borehole", "well", "well_id", "name", "id"),
    "x": ("x", "easting", "east"),
    "y": ("y", "northing", "north"),
    "z": ("z", "collar", "elevation", "elev", "altitude", "rl", "kb", "height"),
    "surface": ("surface", "horizon", "top", "marker", "formation", "unit", "pick"),
    "depth": ("depth", "md", "tvd", "from"),
    "elevation": ("elevation", "elev", "z", "altitude", "rl", "height"),
}
# What stands in the column of depths where a hole did not reach a surface; in small letters.
_NO_DEPTH = frozenset(("", "-", "--", "na", "n/a", "nan", "nr", "null", "none", "absent", "?"))
# Columns that say that a hole is not vertical.
_INCLINED = ("dip", "inclination", "incl", "plunge", "deviation")
_VERTICAL = (0.0, 90.0, -90.0)  # by one convention or another
_KNOWN = frozenset(alias for aliases in _ALIASES.values() for alias in aliases)
_STEP = 5000  # rows


@dataclass
class Picks:
    """points by surface name, (P, 3) float64; warnings, sentences."""

    points: dict[str, np.ndarray] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def read_boreholes(given: Boreholes, model_unit: str = MODEL_UNIT, step: Step = no_step) -> Picks:
    """The points of every surface that the picks name, in the model's unit and the order of the table.

    Holes are vertical; those of which the table says otherwise are told. Rows without a depth are left out,
    and told: the hole did not reach the surface.
    Raises InputRefused naming file and line.
    """
    unit = given.units if isinstance(given.units, Mapping) else {"xy": given.units, "z": given.units}
    scale = np.array([factor(unit.get(axis), model_unit) for axis in ("xy", "xy", "z")])
    inclined: dict[str, None] = {}
    collars = None if given.collars is None else _read_collars(given, inclined)
    found: dict[str, list] = {}
    missing, unused = 0, set(collars or ())
    for row in _rows(given, Path(given.picks), ("hole", "surface"), step):
        place = _place(given, row, collars)
        unused.discard(row.text("hole"))
        if "depth" in row.columns and row.is_inclined():
            inclined[row.text("hole")] = None
        name = row.text("surface")
        if not name:
            raise row.refuse("the surface has no name")
        z = _height(given, row, place)
        if z is None:
            missing += 1
            continue
        found.setdefault(name, []).append((place[0], place[1], z))
    if not found:
        raise InputRefused("there are no picks in it", file=given.picks)
    picks = Picks({name: np.array(places) * scale for name, places in found.items()})
    if missing:
        picks.warnings.append(f"{given.picks}: {missing} picks without a depth are left out")
    if inclined:
        picks.warnings.append(
            f"{given.collars or given.picks}: {number_list(list(inclined))} are not vertical, but depths are "
            "taken as if: give x, y and elevation where they met the surfaces instead"
        )
    if unused:
        picks.warnings.append(f"{given.collars}: no surface was met in {number_list(sorted(unused))}")
    return picks


@dataclass(frozen=True)
class _Row:
    table: Table
    line: int
    entries: list[str]
    columns: dict[str, int]
    decimal: str

    def refuse(self, what: str, advice: str | None = None) -> InputRefused:
        return InputRefused(what, file=self.table.file, line=self.line, advice=advice)

    def text(self, column: str) -> str:
        at = self.columns[column]
        if at >= len(self.entries):
            raise self.refuse(f"{at + 1} values are needed, there are {len(self.entries)}")
        return self.entries[at]

    def is_inclined(self) -> bool:
        """Whether a column says that the hole is not vertical."""
        for at, name in enumerate(self.table.layout.names or ()):
            if plain_name(name) in _INCLINED and at < len(self.entries):
                entry = self.entries[at].replace(",", ".")
                return is_number(entry) and float(entry) not in _VERTICAL
        return False

    def number(self, column: str) -> float:
        entry = self.text(column)
        if not is_number(entry, self.decimal):
            raise self.refuse(f"{column} is not a number: '{entry:.40}'")
        value = float(entry.replace(",", "."))
        if not np.isfinite(value):
            raise self.refuse(f"{column} is {entry}, not a finite number")
        return value


def _rows(given: Boreholes, file: Path, needed: tuple[str, ...], step: Step):
    """The rows of a table, with the columns that it has."""
    names = [column for column in given.columns.values() if isinstance(column, str)]
    table = open_table(file, given.separator, (), {}, _KNOWN | {name.lower() for name in names}, 1, 2)
    columns = _columns(given, table, needed)
    separator = table.layout.separator
    body = table.raw[table.layout.body :].decode(table.encoding)
    decimal = given.decimal or "."
    if (
        given.decimal is None
        and separator != ","
        and not any("." in entry for entry in body[:20_000].split() if is_number(entry))
    ):
        decimal = (
            "," if any(is_number(part, ",") and "," in part for part in _parts(body, separator)) else "."
        )
    total = max(body.count("\n"), 1)
    for number, line in enumerate(body.split("\n")):
        if number % _STEP == 0:
            step(number / total)
        stripped = line.strip()
        if not stripped or stripped.startswith("#"):
            continue
        yield _Row(
            table, table.layout.body_line + number, table.layout.fields(line.rstrip("\r")), columns, decimal
        )


def _parts(body: str, separator: str):
    """Entries of the first lines."""
    for line in body[:20_000].split("\n"):
        yield from fields(line, separator)


def _columns(given: Boreholes, table: Table, needed: tuple[str, ...]) -> dict[str, int]:
    """The numbers of the columns that a table has, by what they are."""
    names = [plain_name(name) for name in table.layout.names or ()]
    columns: dict[str, int] = {}
    for column, aliases in _ALIASES.items():
        called = given.columns.get(column)
        if isinstance(called, int):
            columns[column] = called - 1
        elif called is not None:
            if called.strip().lower() in [name.strip().lower() for name in table.layout.names or ()]:
                columns[column] = table.column(called)
        else:
            at = next((names.index(alias) for alias in aliases if alias in names), None)
            if at is not None and at not in columns.values():
                columns[column] = at
    for column in needed:
        if column not in columns:
            called = given.columns.get(column)
            what = f"the header has no column {called or column}"
            advice = f'say which it is: columns = {{ {column} = "..." }}'
            raise InputRefused(what, file=table.file, line=table.layout.name_line or 1, advice=advice)
    return columns


def _read_collars(given: Boreholes, inclined: dict[str, None]) -> dict[str, tuple[float, float, float]]:
    """Where holes begin, by their names. inclined: gets those that are not vertical."""
    collars: dict[str, tuple[float, float, float]] = {}
    for row in _rows(given, Path(given.collars), ("hole", "x", "y", "z"), no_step):
        hole = row.text("hole")
        place = (row.number("x"), row.number("y"), row.number("z"))
        if collars.setdefault(hole, place) != place:
            raise row.refuse(f"hole '{hole}' has another collar further up", "give each hole one")
        if row.is_inclined():
            inclined[hole] = None
    if not collars:
        raise InputRefused("there are no holes in it", file=given.collars)
    return collars


def _place(given: Boreholes, row: _Row, collars: Mapping | None) -> tuple[float, float, float]:
    """Where the hole of a row stands; its height is NaN where it is not known."""
    hole = row.text("hole")
    if collars is not None:
        if hole not in collars:
            raise row.refuse(f"hole '{hole}' has no collar in {given.collars}", "check how it is written")
        return collars[hole]
    for column in ("x", "y"):
        if column not in row.columns:
            advice = "give the table of collars = ..., or the columns of x and y"
            raise row.refuse(f"the table has no column {column}", advice)
    z = row.number("z") if "z" in row.columns and "depth" in row.columns else float("nan")
    return row.number("x"), row.number("y"), z


def _height(given: Boreholes, row: _Row, place) -> float | None:
    """The height at which a surface was met; None where the row says none."""
    if "depth" in row.columns:
        if row.text("depth").lower() in _NO_DEPTH:
            return None
        if np.isnan(place[2]):
            raise row.refuse("a depth needs the collar's height", "give a column z, or a table of collars")
        return place[2] - row.number("depth")
    column = "elevation" if "elevation" in row.columns else "z" if "z" in row.columns else None
    if column is None:
        raise row.refuse("the table has neither a column depth nor one of elevation")
    return None if row.text(column).lower() in _NO_DEPTH else row.number(column)
