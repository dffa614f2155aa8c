# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenWorks' horizons as text (IJXYZ): lines of keys that begin with @, a line #End_of_Horizon_ASCII_Header_,
rows with the two indices of the grid (or line and trace), x, y and z, and EOD (or EOB) at the end.

The layout is that of xtgeo (`tests/test_surface/test_surface_ijxyz.py`, equinor/xtgeo#36).
"""

from __future__ import annotations

import re
from pathlib import Path

from ....base.errors import InputRefused
from .dialect import FileHeader, comment_units

_END = "#End_of_Horizon_ASCII_Header_"
_BEGINNING = re.compile(rb"\s*@\w+ *:|[^\0]*#End_of_Horizon_ASCII_Header_", re.IGNORECASE)
_NAMES = {3: ("X", "Y", "Z"), 5: ("I", "J", "X", "Y", "Z")}
NOT_ROWS = re.compile(rb"(?m)^[ \t]*(?=EO[BD]\b)")


def begins_as_openworks(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head[:4096]))


def openworks_header(file: Path, lines: list[str]) -> FileHeader:
    """The header of its first lines. Raises InputRefused where a row has neither three nor five numbers."""
    first = next(
        (n for n, line in enumerate(lines) if line.strip() and line.strip()[0] not in "@#"), len(lines)
    )
    count = len(lines[first].split()) if first < len(lines) else 5
    if count not in _NAMES:
        what = f"its rows have {count} columns, not I, J, X, Y and Z"
        raise InputRefused(what, file=file, line=first + 1, advice="remove its header and set columns")
    *others, z = _NAMES[count]
    z = "Z (depth)" if any("depth" in line.lower() for line in lines[:first]) else z
    return FileHeader(first, (*others, z), None, comment_units(lines[:first]))
