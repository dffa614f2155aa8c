# SPDX-License-Identifier: GPL-3.0-or-later
"""A table of places that lie in a block, with its import options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from .boreholes import check_column_names
from .point_file import check_units

COLUMNS = ("x", "y", "z", "block", "hole", "depth")


@dataclass(frozen=True)
class ObservationFile:
    """file: a table with a row for each place that lies in a block: x, y, z and the block; where they are
    known the hole, and the depth along it.

    columns: {"block": "UNIT", ...}, names or numbers from 1 of columns that are called otherwise. separator,
    decimal: as of a PointFile. units: "ft", or {"xy": "m", "z": "ft"}; None: those of the model.
    """

    file: str | Path
    columns: Mapping = field(default_factory=dict)
    separator: str | None = None
    decimal: str | None = None
    units: str | Mapping | None = None

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_column_names(self.columns, COLUMNS)
        check_units(self.units)
