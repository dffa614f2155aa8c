# SPDX-License-Identifier: GPL-3.0-or-later
"""A table of field data, with its import options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from .boreholes import SIGN, check_column_names
from .method_options import check_fields
from .point_file import FILE, checked_units
from .setting import declared, described


@dataclass(frozen=True)
class FieldTable:
    """file: a table with a row for each place.

    columns: names or numbers from 1 of columns that are called otherwise, by the names of `known`. separator,
    decimal: as of a PointFile. units: "ft", or {"xy": "m", "z": "ft"}; None: those of the model.
    """

    known: ClassVar[tuple[str, ...]] = ()

    file: str | Path = described(FILE, is_needed=True)
    columns: Mapping = declared(kind="named_columns", factory=dict)
    separator: str | None = described(SIGN)
    decimal: str | None = described(SIGN)
    units: str | Mapping | None = declared(kind="units", check=checked_units)

    @property
    def files(self) -> list[Path]:
        """The table."""
        return [Path(self.file)]

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_column_names(self.columns, self.known)
        check_fields(self)
