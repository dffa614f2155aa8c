# SPDX-License-Identifier: GPL-3.0-or-later
"""A table of places that lie in a block, with its import options."""

from __future__ import annotations

from dataclasses import dataclass

from .field_table import FieldTable

COLUMNS = ("x", "y", "z", "block", "hole", "depth", "use")


@dataclass(frozen=True)
class ObservationFile(FieldTable):
    """file: a table with a row for each place that lies in a block: x, y, z and the block; where they are
    known the hole, and the depth along it. use: optional, 0 where a row is switched off.

    columns: {"block": "UNIT", ...}, names or numbers from 1 of columns that are called otherwise. separator,
    decimal: as of a PointFile. units: "ft", or {"xy": "m", "z": "ft"}; None: those of the model.
    """

    known = COLUMNS
