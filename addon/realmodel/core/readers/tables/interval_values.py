# SPDX-License-Identifier: GPL-3.0-or-later
"""The other columns of tables of intervals, such as grades: numbers or words along boreholes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, no_step
from ...base.units import MODEL_UNIT, factors
from ...settings.boreholes import Boreholes
from .hole_tables import INTERVALS, NO_VALUE, Row, rows
from .holes import Holes
from .table_layout import is_number

_PLACES = ("hole", "x", "y", "z", "from", "to", "azimuth", "dip", "inclination")  # columns that say where


@dataclass(frozen=True, eq=False)
class IntervalValues:
    """holes: (N,) texts. begins, ends: (N, 3) float64, the ends of the intervals, model units. depths: (N, 2)
    float64 along the hole. columns: by name (N,) numbers, NaN where there are none, or texts."""

    holes: np.ndarray
    begins: np.ndarray
    ends: np.ndarray
    depths: np.ndarray
    columns: dict[str, np.ndarray]

    def has(self, name: str) -> np.ndarray:
        """(N,) bool: which have a value in a column."""
        array = self.columns[name]
        return np.isfinite(array) if array.dtype.kind == "f" else array != ""

    def some(self, chosen: np.ndarray) -> IntervalValues:
        """Some of them. chosen: (N,) bool, or numbers of rows."""
        columns = {name: array[chosen] for name, array in self.columns.items()}
        begins, ends = self.begins[chosen], self.ends[chosen]
        return IntervalValues(self.holes[chosen], begins, ends, self.depths[chosen], columns)

    @classmethod
    def joined(cls, parts: Sequence[IntervalValues]) -> IntervalValues:
        """Several, one after another; columns that some lack have no value there."""
        names = list(dict.fromkeys(name for part in parts for name in part.columns))
        columns = {name: _joined(name, parts) for name in names}
        keys = ("holes", "begins", "ends", "depths")
        arrays = {key: np.concatenate([getattr(part, key) for part in parts]) for key in keys}
        return cls(**arrays, columns=columns)


def _joined(name: str, parts: Sequence[IntervalValues]) -> np.ndarray:
    columns = [part.columns.get(name) for part in parts]
    are_numbers = all(array is None or array.dtype.kind == "f" for array in columns)
    lacking = np.nan if are_numbers else ""
    arrays = [
        np.full(len(part.holes), lacking) if array is None else array if are_numbers else _texts(array)
        for part, array in zip(parts, columns, strict=True)
    ]
    return np.concatenate(arrays)


def _texts(array: np.ndarray) -> np.ndarray:
    return (
        array if array.dtype.kind != "f" else np.array(["" if v != v else f"{v:g}" for v in array.tolist()])
    )


def read_interval_values(
    given: Boreholes, model_unit: str = MODEL_UNIT, step: Step = no_step
) -> IntervalValues:
    """The columns of the table of intervals of some boreholes that do not say where an interval is, in the
    order of the table. A column is of numbers where all its values are numbers. Rows without a depth, and
    of holes without a collar, are left out. Raises InputRefused naming file and line."""
    assert given.intervals is not None
    plan, height = factors(given.units, model_unit)
    scale = np.array([plan, plan, height])
    holes, read, ends, depths = Holes(given), [], [], []
    names: list[str] = []
    refused: InputRefused | None = None
    for row in rows(given, Path(given.intervals), INTERVALS, ("hole", "from", "to"), step):
        if not names:
            names = _names(row)
        if not (row.has("from") and row.has("to")):
            continue
        between = row.number("from"), row.number("to")
        if holes.without_collar(row, between[0], "") is not None:
            refused = refused or holes.refuse_all(row)
            continue
        ends.append([holes.place(row, depth, scale) for depth in between])
        depths.append(between)
        read.append((holes.hole_of(row), row.entries, row.decimal))
    if not read:
        raise refused or InputRefused("there are no intervals in it", file=given.intervals)
    columns = {name: _column(read, at) for at, name in enumerate(names) if name}
    places = np.array(ends, np.float64)
    texts = np.array([hole for hole, _, _ in read], str)
    return IntervalValues(texts, places[:, 0], places[:, 1], np.array(depths), columns)


def _names(row: Row) -> list[str]:
    """The names of the columns as they are written; empty for those that say where an interval is."""
    names = [name.strip() for name in row.table.layout.names or ()]
    for column in _PLACES:
        if column in row.columns and row.columns[column] < len(names):
            names[row.columns[column]] = ""
    return names


def _column(read: list[tuple[str, list[str], str]], at: int) -> np.ndarray:
    entries = [row[at].strip() if at < len(row) else "" for _, row, _ in read]
    decimals = [decimal for _, _, decimal in read]
    lacking = [entry.lower() in NO_VALUE for entry in entries]
    triples = list(zip(entries, lacking, decimals, strict=True))
    if all(lacks or is_number(entry, decimal) for entry, lacks, decimal in triples):
        values = [np.nan if lacks else float(entry.replace(",", ".")) for entry, lacks, _ in triples]
        return np.array(values, np.float64)
    return np.array(["" if lacks else entry for entry, lacks, _ in triples], str)
