# SPDX-License-Identifier: GPL-3.0-or-later
"""Values along boreholes: grades and notes of intervals, and curves of logs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.no_value import NO_VALUE
from .table_layout import is_number


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


def column_values(read: Sequence[tuple[str, list[str], str]], at: int) -> np.ndarray:
    """(N,) a column of rows (hole, entries, decimal sign): numbers where all values are, else texts."""
    entries = [row[at].strip() if at < len(row) else "" for _, row, _ in read]
    decimals = [decimal for _, _, decimal in read]
    lacking = [entry.lower() in NO_VALUE for entry in entries]
    triples = list(zip(entries, lacking, decimals, strict=True))
    if all(lacks or is_number(entry, decimal) for entry, lacks, decimal in triples):
        values = [np.nan if lacks else float(entry.replace(",", ".")) for entry, lacks, _ in triples]
        return np.array(values, np.float64)
    return np.array(["" if lacks else entry for entry, lacks, _ in triples], str)
