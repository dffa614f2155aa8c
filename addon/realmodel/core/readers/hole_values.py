# SPDX-License-Identifier: GPL-3.0-or-later
"""Logs along boreholes, of LAS files: each sample of a curve is an interval, up to the middle between it and
the next one.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from pathlib import Path

import numpy as np

from ..base.errors import InputRefused, number_list
from ..base.text import Step, no_step, reading
from ..base.units import MODEL_UNIT, factor, unit_of
from ..settings.data_files import Boreholes
from .hole_files import read_hole_files
from .holes.las import begins_as_las, read_las, well_names
from .tables.hole_data import HoleTables
from .tables.hole_repair import repair
from .tables.hole_tables import RawTable, Row, TableHeader, normalized_name
from .tables.holes import Holes
from .tables.interval_values import IntervalValues, column_values

_HEAD = 4096  # bytes that tell what a file is
_MOST_PLACES = 2000  # along a hole; between them it is straight


def is_log(file: Path) -> bool:
    """Whether a file is one of logs. Raises InputRefused where it cannot be read."""
    with reading(file), Path(file).open("rb") as opened:
        return begins_as_las(opened.read(_HEAD))


def read_logs(tables: HoleTables, holes: Holes, model_unit: str) -> list[IntervalValues]:
    """The curves of the logs of boreholes, one after another; those of one name, too, by the numbers 2, 3 and
    so on. A unit stands in brackets behind the name of its curve. tables: repaired; what there is to say is
    added to their warnings. Raises InputRefused, also where a well is no hole of the tables."""
    rows = _rows_of_holes(tables)
    sheets = {file: _curves(file) for file in tables.boreholes.log_files}
    holes_of = {file: _hole(file, sheet, rows) for file, sheet in sheets.items()}
    strangers = [f"'{sheet.rows[0][1][0]}'" for file, sheet in sheets.items() if holes_of[file] is None]
    if strangers:
        file = next(file for file, hole in holes_of.items() if hole is None)
        advice = "give the table of collars = ..."
        if rows:
            advice = (
                f"there are {number_list(sorted(rows))}; write it so in one of them, or leave the log out"
            )
        raise InputRefused(
            f"no hole is called {number_list(strangers)}, as its well is", file=file, advice=advice
        )
    scale = tables.scale(model_unit)
    logs = []
    for file, sheet in sheets.items():
        row = rows[str(holes_of[file])]
        bounds = _bounds(tables, file, sheet, model_unit)
        row = row if "from" in row.columns or "depth" in row.columns else _named(file, row.text("hole"))
        depths = np.unique(bounds)
        depths = depths[np.unique(np.linspace(0, len(depths) - 1, _MOST_PLACES).round().astype(int))]
        places = np.array([holes.place(row, depth, scale) for depth in depths.tolist()])
        begins, ends = (
            np.column_stack([np.interp(bounds[:, side], depths, axis) for axis in places.T])
            for side in (0, 1)
        )
        names = np.full(len(bounds), row.text("hole"))
        logs.append(IntervalValues(names, begins, ends, bounds, _columns(sheet)))
    return logs


def _curves(file: Path) -> RawTable:
    if not is_log(file):
        raise InputRefused("it is not a LAS file", file=file, advice="export the log as LAS")
    sheet = read_las(file).get("intervals")
    if sheet is None or not sheet.rows:
        raise InputRefused("it has no curves", file=file)
    return sheet


def _rows_of_holes(tables: HoleTables) -> dict[str, Row]:
    """A row of each hole, with its start: of collars or, without them, of picks or intervals."""
    rows = tables.collars
    if rows is None:
        rows = [*(tables.picks or ()), *(tables.intervals or ())]
    return {row.text("hole"): row for row in reversed(rows)}


def _hole(file: Path, sheet: RawTable, holes: Mapping[str, Row]) -> str | None:
    """The hole that is called as the well of a file; None where none is."""
    alike = {normalized_name(hole): hole for hole in holes}
    for name in (sheet.rows[0][1][0], *well_names(file)):
        if name in holes or normalized_name(name) in alike:
            return name if name in holes else alike[normalized_name(name)]
    return None


def _named(file: Path, hole: str) -> Row:
    """A row with the name of the hole."""
    return Row(TableHeader(file, ("hole", "from"), 1, {"hole": 0, "from": 1}), 1, [hole, ""])


def _bounds(tables: HoleTables, file: Path, sheet: RawTable, model_unit: str) -> np.ndarray:
    """(N, 2) the depths of the samples, in the unit of the tables: the file says its own."""
    of_tables = tables.boreholes.units
    of_tables = (of_tables.get("z") if isinstance(of_tables, Mapping) else of_tables) or model_unit
    text = sheet.units[1] if len(sheet.units) > 1 else ""
    unit = unit_of(text)
    if unit is None and text:
        advice = "write the unit of the depths into the file, such as M or FT"
        raise InputRefused(f"'{text}' is not a unit of length", file=file, line=sheet.line, advice=advice)
    if unit not in (None, of_tables):
        tables.warnings.append(f"{file}: its depths are in {unit}, as stated: converted to {of_tables}")
    bounds = np.array([[float(entry) for entry in entries[1:3]] for _, entries in sheet.rows])
    return bounds * (1.0 if unit is None else factor(unit, of_tables))


def _columns(sheet: RawTable) -> dict[str, np.ndarray]:
    read = [("", entries, ".") for _, entries in sheet.rows]
    columns: dict[str, np.ndarray] = {}
    for at, name in enumerate(sheet.names):
        if at < 3:  # hole, from, to
            continue
        unit = sheet.units[at] if at < len(sheet.units) else ""
        names = (f"{name} {n}" if n > 1 else name for n in count(1))
        names_with_units = (f"{name} ({unit})" if unit else name for name in names)
        columns[next(name for name in names_with_units if name not in columns)] = column_values(read, at)
    return columns


_PLACES = ("hole", "x", "y", "z", "from", "to", "azimuth", "dip", "inclination")  # columns that say where


def read_interval_values(
    given: Boreholes, model_unit: str = MODEL_UNIT, step: Step = no_step
) -> IntervalValues:
    """The columns of the table of intervals of some boreholes that do not say where an interval is, in the
    order of the table, and the curves of their logs. A column is of numbers where all its values are numbers.
    Rows without a depth, and of holes without a collar, are left out. Raises InputRefused naming file and
    line."""
    tables = read_hole_files(given, model_unit, step, ("hole", "from", "to"))
    repair(tables)
    return interval_values(tables, model_unit)


def interval_values(tables: HoleTables, model_unit: str) -> IntervalValues:
    """The same of tables that are repaired."""
    holes = Holes(tables)
    parts = read_logs(tables, holes, model_unit)
    rows = [row for row in tables.intervals or () if row.has("from") and row.has("to")]
    if rows:
        parts.insert(0, _values_of(rows, holes, tables.scale(model_unit)))
    if not parts:
        raise InputRefused("there are no intervals in it", file=tables.boreholes.intervals)
    return IntervalValues.joined(parts)


def _values_of(rows: list[Row], holes: Holes, scale: np.ndarray) -> IntervalValues:
    read, ends, depths = [], [], []
    for row in rows:
        between = row.number("from"), row.number("to")
        ends.append([holes.place(row, depth, scale) for depth in between])
        depths.append(between)
        read.append((row.text("hole"), row.entries, row.decimal))
    columns = {name: column_values(read, at) for at, name in enumerate(_names(rows[0])) if name}
    places = np.array(ends, np.float64)
    texts = np.array([hole for hole, _, _ in read], str)
    return IntervalValues(texts, places[:, 0], places[:, 1], np.array(depths), columns)


def _names(row: Row) -> list[str]:
    """The names of the columns as they are written; empty for those that say where an interval is."""
    names = [name.strip() for name in row.header.names]
    for column in _PLACES:
        if column in row.columns and row.columns[column] < len(names):
            names[row.columns[column]] = ""
    return names
