# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of boreholes after reading, row by row, for all formats."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ...base.text import Step, no_step
from ...base.units import factors
from ...settings.data_files import Boreholes
from .hole_problems import HoleProblem
from .hole_tables import (
    COLLARS,
    INTERVALS,
    SURVEY,
    Columns,
    RawTable,
    Row,
    column_key,
    header_factors,
    may_name_units,
    rows,
    sheet_rows,
    with_units_of_cells,
)
from .table_layout import names_shown

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
    say others. block_column: the one that was chosen among several, "" where there is no choice. system: the
    coordinate system that the file names, as of RawTable. problems: what was wrong with rows, as far as they
    are repaired. warnings: sentences. lines: of holes of objects, in the units of the tables: the places
    (N, 3) of depths (N,); picks of objects are at their own places. None of tables. without_blocks: what to
    write where no column names the units of intervals, "" else."""

    boreholes: Boreholes
    collars: list[Row] | None = None
    survey: list[Row] | None = None
    picks: list[Row] | None = None
    intervals: list[Row] | None = None
    factors: dict[str, dict[str, float]] = field(default_factory=dict)
    block_column: str = ""
    system: str = ""
    problems: list[HoleProblem] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    lines: dict[str, tuple[np.ndarray, np.ndarray]] | None = None
    without_blocks: str = ""

    def copy(self) -> HoleTables:
        """The same rows in other lists, which may be repaired."""
        copied = replace(self, factors={kind: dict(of) for kind, of in self.factors.items()})
        for name in ("collars", "survey", "picks", "intervals", "problems", "warnings"):
            rows = getattr(self, name)
            setattr(copied, name, None if rows is None else list(rows))
        return copied

    def scale(self, model_unit: str) -> np.ndarray:
        """(3,) the factors of x, y and of heights and depths to the model's unit."""
        plan, height = factors(self.boreholes.units, model_unit)
        return np.array([plan, plan, height])


def read_hole_rows(
    boreholes: Boreholes,
    model_unit: str,
    step: Step = no_step,
    needed: tuple[str, ...] | None = None,
    sheets: Mapping[str, RawTable | str] | None = None,
) -> HoleTables:
    """The rows of the tables of some boreholes as they are. needed: the columns of intervals that there must
    be; None: with the block. sheets: tables of files that hold several, by their kind, or the names of those
    of a workbook. Raises InputRefused naming file and line."""
    required = _NEEDED | ({} if needed is None else {"intervals": needed})
    sheets = sheets or {}
    tables = HoleTables(boreholes)
    for kind, known in MEANINGS.items():
        file = getattr(boreholes, kind)
        if file is None:
            continue
        table = sheets.get(kind)
        is_log = kind == "intervals" and Path(file) in boreholes.log_files
        if is_log:
            continue
        if isinstance(table, RawTable) and "block" in required[kind] and not _has_blocks(boreholes, table):
            if not table.is_log:
                listed = names_shown([name for name in table.names if name])
                tables.without_blocks = f'columns = {{ block = "..." }}; it has {listed}'
                what = "no column names the units of its intervals, which are not used"
                tables.warnings.append(f"{file}:{table.line}: {what}: name it: {tables.without_blocks}")
            continue
        slow = step if kind in ("picks", "intervals") else no_step
        if isinstance(table, RawTable):
            table_rows = sheet_rows(boreholes, Path(file), table, known, required[kind])
            choice = table.choice
            tables.system = tables.system or table.system
        else:
            table_rows = list(rows(boreholes, Path(file), known, required[kind], slow, table))
            choice = _choice(table_rows) if kind == "intervals" else None
        if choice is not None and "block" not in boreholes.columns:
            tables.block_column, text = choice
            tables.warnings.append(f"{file}: {text}")
        table_rows = with_units_of_cells(table_rows)
        setattr(tables, kind, table_rows)
        if table_rows:
            header = table_rows[0].header
            tables.factors[kind], warnings = header_factors(header, boreholes.units, model_unit)
            tables.warnings += warnings
    return tables


def _choice(every: list[Row]) -> tuple[str, str] | None:
    """The column of blocks and what is said of it, where another one that may name them divides the rows
    otherwise."""
    header = every[0].header if every else None
    if header is None or "block" not in header.columns:
        return None
    aliases, taken = set(map(column_key, INTERVALS["block"])), header.columns["block"]

    def texts(at: int) -> list[str]:
        return [row.entries[at] if at < len(row.entries) else "" for row in every]

    blocks = texts(taken)
    for at, other in enumerate(header.names):
        if at in header.columns.values() or column_key(other) not in aliases:
            continue
        named, distinct = texts(at), set(texts(at))
        is_number_of_row = all(map(str.isdigit, distinct - {""}))
        if len(distinct) < 2 or is_number_of_row or not may_name_units(named):
            continue
        if len(set(zip(blocks, named, strict=True))) > min(len(set(blocks)), len(distinct)):
            name = header.names[taken]
            text = f"'{other}' divides the rows otherwise: columns = {{ block = \"{other}\" }}"
            return name, f"blocks are named by '{name}'; {text}"
    return None


def _has_blocks(boreholes: Boreholes, sheet: RawTable) -> bool:
    """Whether a table has a column that names blocks."""
    keys = set(map(column_key, sheet.names))
    return "block" in boreholes.columns or not keys.isdisjoint(map(column_key, INTERVALS["block"]))
