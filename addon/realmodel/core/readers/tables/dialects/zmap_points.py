# SPDX-License-Identifier: GPL-3.0-or-later
"""ZMAP+ points and polygons (Landmark, Zycor): comments (!), between two @ a line for each column that
begins with its name, then rows.

The layout is that of files that RMS writes (`top_upper_reek_faultpoly.zmap` of equinor/xtgeo-testdata).
"""

from __future__ import annotations

import re
from pathlib import Path

from ....base.errors import InputRefused
from .dialect import FileHeader, comment_units

_BEGINNING = re.compile(rb"(?:\s*[!+].*\n)*\s*@[^\n]*,\s*DATA\s*,", re.IGNORECASE)


def begins_as_zmap_points(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head.replace(b"\r", b"\n")))


def zmap_points_header(file: Path, lines: list[str]) -> FileHeader:
    """The header of its first lines. Raises InputRefused where it has no end."""
    first, end = [*(n for n, line in enumerate(lines) if line.strip().startswith("@")), -1, -1][:2]
    if end < 0:
        what = "the header has no second @"
        raise InputRefused(what, file=file, line=first + 1, advice="the file is cut off")
    columns = (line for line in lines[first + 1 : end] if line.strip() and not line.strip().startswith("!"))
    names = tuple(line.split(",")[0].strip() for line in columns)
    return FileHeader(end + 1, names, first, comment_units(lines[:first]))
