# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes: their collars, and the depths at which they meet surfaces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .method_options import OptionRefused, check_fields
from .point_file import FILE, checked_name, checked_units
from .setting import Setting, declared, described

COLUMNS = (
    *("hole", "x", "y", "z", "surface", "depth", "elevation", "azimuth", "dip", "inclination"),
    *("from", "to", "block", "end", "use"),
)
DOWNWARD_DIPS = ("negative", "positive")
SIGN = Setting(kind="sign")  # a character of a table


def check_column_names(columns: Any, known: Sequence[str]) -> None:
    """Refuses columns that are no table of names or numbers by known meanings. Raises OptionRefused."""
    if not isinstance(columns, Mapping):
        what = f"'columns' must be a table of column names, not {columns!r}"
        raise OptionRefused(what, "columns", f'write columns = {{ {known[0]} = "BHID" }}')
    for name, column in columns.items():
        if name not in known:
            what = f"'columns' has an unknown column '{name}'"
            raise OptionRefused(what, "columns", f"there are {', '.join(known)}")
        is_number = isinstance(column, int) and not isinstance(column, bool) and 1 <= column <= 100_000
        if not is_number and not (isinstance(column, str) and column.strip()):
            what = f"column '{name}' must be a name or a number from 1, not {column!r}"
            raise OptionRefused(what, "columns")


def _checked_sense(key: str, sense: Any) -> Any:
    if sense is not None and sense not in DOWNWARD_DIPS:
        raise OptionRefused(f'\'{key}\' must be "negative" or "positive", not {sense!r}', key)
    return sense


@dataclass(frozen=True)
class Boreholes:
    """Boreholes, tables or objects of a file, which give points and bounds for all surfaces of a rock mass.

    picks: a table with a row for each surface met in a hole: hole, surface, and its depth below the
    collar (along the hole), or its elevation. intervals: a table with a row for each logged interval:
    hole, from, to (along the hole) and block. One of the two, or both. collars: a table with a row for
    each hole: hole, x, y, z, azimuth and dip or inclination where it is straight but not vertical, and the
    depth of its end, which is only shown;
    None where the rows of picks and intervals have x, y and z themselves. survey: a table with a row for
    each place where the direction of a hole was measured: hole, depth along it, azimuth in degrees
    clockwise from north (+y), and either the inclination in degrees from the vertical or the dip from the
    horizontal; None: holes go as the collars say, or straight down. use: an optional column of picks and
    intervals, 0 where a row is switched off. downward_dip: "negative" or
    "positive", which dips go down; None: all of a table go the same way, down. columns: {"hole": "BHID",
    ...}, names or numbers from 1 of columns that are called otherwise, in whichever tables have them.
    separator, decimal: as of a PointFile, of all tables. units: of all, "ft", or {"xy": "m", "z": "ft"}
    (depths are in the unit of z); None: those of the model.
    Where `picks` or `intervals` is an OMF or geoh5 file, `layer` is its object with the boreholes (None: all
    of its boreholes), and columns names its data `surface`, `block` and `hole`; the other keys are for
    tables.
    """

    picks: str | Path | None = described(FILE)
    collars: str | Path | None = described(FILE)
    columns: Mapping = declared(kind="named_columns", factory=dict)
    separator: str | None = described(SIGN)
    decimal: str | None = described(SIGN)
    units: str | Mapping | None = declared(kind="units", check=checked_units)
    survey: str | Path | None = described(FILE)
    downward_dip: str | None = declared(kind="sense", check=_checked_sense)
    intervals: str | Path | None = described(FILE)
    layer: str | None = declared(kind="layer", check=checked_name)

    @property
    def only_for_tables(self) -> list[str]:
        """The keys given that only tables can have."""
        keys = ("collars", "survey", "separator", "decimal", "downward_dip")
        return [key for key in keys if getattr(self, key)]

    @property
    def files(self) -> list[Path]:
        """The tables that there are."""
        tables = (self.collars, self.survey, self.picks, self.intervals)
        return [Path(file) for file in tables if file is not None]

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        if self.picks is None and self.intervals is None:
            what = "there are neither picks nor intervals"
            raise OptionRefused(what, "picks", "give the table of picks = ... or intervals = ...")
        check_column_names(self.columns, COLUMNS)
        check_fields(self)
