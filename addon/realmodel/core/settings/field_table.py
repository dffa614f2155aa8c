# SPDX-License-Identifier: GPL-3.0-or-later
"""A table of field data, with its import options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from .boreholes import check_column_names
from .point_file import check_units


@dataclass(frozen=True)
class FieldTable:
    """file: a table with a row for each place.

    columns: names or numbers from 1 of columns that are called otherwise, by the names of `known`. separator,
    decimal: as of a PointFile. units: "ft", or {"xy": "m", "z": "ft"}; None: those of the model.
    """

    known: ClassVar[tuple[str, ...]] = ()

    file: str | Path
    columns: Mapping = field(default_factory=dict)
    separator: str | None = None
    decimal: str | None = None
    units: str | Mapping | None = None

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_column_names(self.columns, self.known)
        check_units(self.units)
