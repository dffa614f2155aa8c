# SPDX-License-Identifier: GPL-3.0-or-later
"""The kinds of series, and the resolution of their fields and how thick beds of these are."""

from __future__ import annotations

from typing import Any

from ..base.algebra import is_number

BY_DATA = "auto"  # by the data
FIELD, SHEETS = "field", "sheets"
KINDS = {
    FIELD: (
        "Field",
        "Level sets of one scalar field in space: they may be vertical, overturned or recumbent",
    ),
    SHEETS: ("Sheets", "Sheets with one elevation at each position, interpolated together"),
}

PARALLEL, FREE = "parallel", "free"
THICKNESSES = {  # of the beds of a field
    BY_DATA: (
        "Automatic",
        "Beds keep their thickness away from the data if this predicts left-out data better",
    ),
    PARALLEL: (
        "Parallel",
        "Beds keep their thickness around bends and away from the data, as in parallel folds",
    ),
    FREE: (
        "Free",
        "Beds get thicker or thinner away from the data, as the smoothest field does",
    ),
}

SHEET_METHODS = ("universal_kriging", "kriging", "dsi")  # by which sheets are interpolated together


def resolution_fault(resolution: Any) -> str | None:
    """The error in a resolution, "auto" included, or None."""
    if isinstance(resolution, str) and resolution == BY_DATA:
        return None
    if is_number(resolution) and resolution > 0:
        return None
    return f"resolution must be a finite number above 0 or '{BY_DATA}', not {resolution!r}"
