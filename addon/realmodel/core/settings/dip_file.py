# SPDX-License-Identifier: GPL-3.0-or-later
"""A table of dips with its import options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from .boreholes import check_column_names
from .point_file import check_units

COLUMNS = ("x", "y", "z", "dip", "dip_direction", "strike", "polarity", "slope_x", "slope_y")


@dataclass(frozen=True)
class DipFile:
    """file: a table of dips of a surface: x, y, z (optional), dip, and dip_direction or strike, in degrees.

    dip: below the horizontal. dip_direction: clockwise from north (+y). strike: by the right-hand rule, the
    dip direction is 90 degrees clockwise from it. polarity: optional, 1; -1, overturned, is refused.
    slope_x and slope_y, how much the surface rises along x and along y, may take the place of angles.
    columns: {"dip": "INCL", ...}, names or numbers from 1 of columns that are called otherwise. separator,
    decimal: as of a PointFile. units: of x, y and z, "ft", or {"xy": "m", "z": "ft"}; None: those of the
    model.
    """

    file: str | Path
    columns: Mapping = field(default_factory=dict)
    separator: str | None = None
    decimal: str | None = None
    units: str | Mapping | None = None

    def check(self) -> None:
        """Raises OptionRefused for a key that makes no sense."""
        check_column_names(self.columns, COLUMNS, 'write columns = { dip = "INCL" }')
        check_units(self.units)
