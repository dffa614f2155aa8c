# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of boreholes as they are read, row by row, whatever format they come from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused, number_list
from ...base.text import Step, no_step
from ...base.units import factor, factors, other_units, unit_of, unit_of_column, unknown_unit
from ...settings.data_files import Boreholes
from .hole_problems import HoleProblem
from .hole_tables import (
    COLLARS,
    INTERVALS,
    LENGTHS,
    SURVEY,
    Columns,
    RawTable,
    Row,
    TableHeader,
    column_key,
    rows,
    sheet_rows,
)

MEANINGS: dict[str, Columns] = {
    "collars": COLLARS,
    "survey": SURVEY,
    "picks": COLLARS,
    "intervals": INTERVALS,
}
_NEEDED = {
    "collars": ("hole", "x", "y", "z"),
    "survey": ("hole", "depth", "azimuth"),
    "picks": ("hole", "surface"),
    "intervals": ("hole", "from", "to", "block"),
}


@dataclass
class HoleTables:
    """boreholes: what they were read from. collars, survey, picks, intervals: their rows, None where there is
    no such table. factors: to the units in which they are read, by kind of table and column, for those that
    say others. problems: what was wrong with rows, as far as they are repaired. warnings: sentences."""

    boreholes: Boreholes
    collars: list[Row] | None = None
    survey: list[Row] | None = None
    picks: list[Row] | None = None
    intervals: list[Row] | None = None
    factors: dict[str, dict[str, float]] = field(default_factory=dict)
    problems: list[HoleProblem] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def scale(self, model_unit: str) -> np.ndarray:
        """(3,) the factors of x, y and of heights and depths to the model's unit."""
        plan, height = factors(self.boreholes.units, model_unit)
        return np.array([plan, plan, height])


def read_hole_rows(
    boreholes: Boreholes,
    model_unit: str,
    step: Step = no_step,
    needed: tuple[str, ...] | None = None,
    sheets: dict[str, RawTable] | None = None,
) -> HoleTables:
    """The rows of the tables of some boreholes as they are. needed: the columns of intervals that there must
    be; None: with the block. sheets: tables of files that hold several, by their kind. Raises
    InputRefused naming file and line."""
    required = _NEEDED | ({} if needed is None else {"intervals": needed})
    sheets = sheets or {}
    tables = HoleTables(boreholes)
    for kind, known in MEANINGS.items():
        file = getattr(boreholes, kind)
        if file is None:
            continue
        is_log = kind == "intervals" and Path(file) in boreholes.log_files
        if is_log or (
            kind in sheets and "block" in required[kind] and not _has_blocks(boreholes, sheets[kind])
        ):
            continue  # curves of a log
        slow = step if kind in ("picks", "intervals") else no_step
        if kind in sheets:
            table_rows = sheet_rows(boreholes, Path(file), sheets[kind], known, required[kind])
            if sheets[kind].choice and "block" not in boreholes.columns:
                tables.warnings.append(f"{file}: {sheets[kind].choice}")
        else:
            table_rows = list(rows(boreholes, Path(file), known, required[kind], slow))
        setattr(tables, kind, table_rows)
        tables.factors[kind] = _to_one_unit(tables, table_rows, model_unit)
    return tables


def _has_blocks(boreholes: Boreholes, sheet: RawTable) -> bool:
    """Whether a table has a column that names blocks."""
    keys = set(map(column_key, sheet.names))
    return "block" in boreholes.columns or not keys.isdisjoint(map(column_key, INTERVALS["block"]))


def _to_one_unit(tables: HoleTables, table_rows: list[Row], model_unit: str) -> dict[str, float]:
    """The factors of columns to the unit in which they are read: that of the model where the user does not
    say it. Raises InputRefused for a unit that is not known."""
    if not table_rows:
        return {}
    header, units = table_rows[0].header, tables.boreholes.units
    units = units if isinstance(units, Mapping) else {"xy": units, "z": units}
    factors_of: dict[str, float] = {}
    said: dict[str, list[str]] = {}
    for meaning, text in header.units.items():
        unit, read = unit_of(text), units.get("xy" if meaning in ("x", "y") else "z")
        if meaning not in LENGTHS or read is not None:
            continue
        if unit is None and unknown_unit(text):
            what = (
                f"the unit of column '{header.names[header.columns[meaning]].strip()}' is not one of length"
            )
            raise InputRefused(what, file=header.file, line=header.line, advice="say it: units = ...")
        if unit not in (None, model_unit):
            factors_of[meaning] = factor(unit, model_unit)
            said.setdefault(unit, []).append(f"'{header.names[header.columns[meaning]].strip()}'")
    tables.warnings += [
        f"{header.file}: the header says {unit} for {number_list(names)}: converted to {model_unit}; "
        "set units if it is another"
        for unit, names in said.items()
    ]
    tables.warnings += _contradicted(header, units, model_unit)
    return factors_of


def _contradicted(header: TableHeader, units: Mapping, model_unit: str) -> list[str]:
    """The warnings about units in a header other than those that the user says."""
    columns: dict[str, str | None] = {}
    for meaning, text in header.units.items():
        read = units.get("xy" if meaning in ("x", "y") else "z")
        if meaning in LENGTHS and read is not None:
            name = header.names[header.columns[meaning]].strip()
            columns[name if unit_of_column(name) else f"{name} ({text})"] = read
    return other_units(header.file, columns, model_unit)
