# SPDX-License-Identifier: GPL-3.0-or-later
"""EarthVision's scattered data and grids as text: comments of keys, among them "# Field: 3 z meters" for each
column and "# Units:" of the plan coordinates, then rows with blanks between them.

The layout is that of xtgeo (`map_export_ev_ascii.c`) and of files that RMS writes (equinor/xtgeo#534).
"""

from __future__ import annotations

import re
from pathlib import Path

from ....base.errors import InputRefused
from .dialect import FileHeader, comment_units

_FIELD = re.compile(r"#\s*Field:\s*(\d+)\s+(\S+)(?:\s+(.+?))?\s*$", re.IGNORECASE)
_TYPES = ("integer", "real", "text", "string", "non-numeric")


def begins_as_earthvision(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return any(_FIELD.match(line.decode("latin-1").strip()) for line in head[:4096].splitlines())


def earthvision_header(file: Path, lines: list[str]) -> FileHeader:
    """The header of its first lines. Raises InputRefused where it has more fields than a row may have."""
    fields = {n: match for n, line in enumerate(lines) if (match := _FIELD.match(line.strip()))}
    name_line = max(fields)
    names: dict[int, str] = {}
    for n, field in fields.items():
        if not 1 <= len(field[1]) <= 4:
            raise InputRefused(f"there is no field {field[1]:.20}", file=file, line=n + 1)
        unit = field[3] if field[3] and field[3].lower() not in _TYPES else ""
        names[int(field[1]) - 1] = f"{field[2]} ({unit})" if unit else field[2]
    behind = range(name_line + 1, len(lines))
    rows = next((n for n in behind if lines[n].strip() and lines[n].strip()[0] != "#"), len(lines))
    listed = tuple(names.get(n, f"column {n + 1}") for n in range(max(names) + 1))
    return FileHeader(rows, listed, name_line, comment_units(lines[:rows]))
