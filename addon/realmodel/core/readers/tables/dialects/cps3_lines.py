# SPDX-License-Identifier: GPL-3.0-or-later
"""CPS-3 lines and points (Schlumberger), as Petrel writes polygons and faults: lines of keys that begin
with FF (or FC), a line "->name" before each polyline, then rows of x, y and z.

The layout is that of Petrel's export "CPS-3 lines (ASCII)", as far as its users show it in public; no
public file of it was found.
"""

from __future__ import annotations

import re
from pathlib import Path

from ....base.errors import InputRefused
from .dialect import FileHeader, comment_units

_BEGINNING = re.compile(rb"(?:\s*[!#].*\n)*\s*F[A-RT-Z](?:ASCI|ATTR|LIMI|NROW|XINC)\b")
NOT_ROWS = re.compile(rb"(?m)^[ \t]*(?=->|[A-Z]{6}\b)")


def begins_as_cps3_lines(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head.replace(b"\r", b"\n")))


def cps3_lines_header(file: Path, lines: list[str]) -> FileHeader:
    """The header of its first lines. Raises InputRefused where rows have no z."""
    rows = next(
        (n for n, line in enumerate(lines) if line.strip() and line.strip()[0] not in "#!"), len(lines)
    )
    if rows < len(lines) and len(lines[rows].split()) < 3:
        what = "its rows have no z"
        raise InputRefused(what, file=file, line=rows + 1, advice="export the lines with their depths")
    return FileHeader(rows, ("X", "Y", "Z"), None, comment_units(lines[:rows]))
