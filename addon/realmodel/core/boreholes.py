# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes: where they stand, and at which depth each surface was met."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from .point_file import ReadingRefused, check_units

COLUMNS = ("hole", "x", "y", "z", "surface", "depth", "elevation")


@dataclass(frozen=True)
class Boreholes:
    """Tables of vertical boreholes, which give points for all surfaces of a rock mass at once.

    picks: a table with a row for each surface met in a hole: hole, surface, and its depth below the collar,
    or its elevation. collars: a table with a row for each hole: hole, x, y, z; None where the rows of picks
    have these themselves. columns: {"hole": "BHID", ...}, names or numbers from 1 of columns that are called
    otherwise, in whichever table has them. separator, decimal: as of a PointFile, of both tables. units: of
    both, "ft", or {"xy": "m", "z": "ft"} (depths are in the unit of z); None: those of the model.
    """

    picks: str | Path
    collars: str | Path | None = None
    columns: Mapping = field(default_factory=dict)
    separator: str | None = None
    decimal: str | None = None
    units: str | Mapping | None = None

    @property
    def files(self) -> list[Path]:
        return [Path(file) for file in (self.collars, self.picks) if file is not None]

    def check(self) -> None:
        """Raises ReadingRefused for a key that makes no sense."""
        if not isinstance(self.columns, Mapping):
            what = f"'columns' must say how columns are called, not {self.columns!r}"
            raise ReadingRefused("columns", what, 'write columns = { hole = "BHID" }')
        for name, column in self.columns.items():
            if name not in COLUMNS:
                what = f"'columns' names a column '{name}'"
                raise ReadingRefused("columns", what, f"there are {', '.join(COLUMNS)}")
            is_number = isinstance(column, int) and not isinstance(column, bool) and 1 <= column <= 100_000
            if not is_number and not (isinstance(column, str) and column.strip()):
                what = f"column '{name}' must be a name or a number from 1, not {column!r}"
                raise ReadingRefused("columns", what)
        check_units(self.units)
