# SPDX-License-Identifier: GPL-3.0-or-later
"""Geo-EAS tables, which GSLIB and most programs of geostatistics write: a title, the number of columns, a
line with the name of each, then rows with blanks between them.

The layout is that of C. V. Deutsch and A. G. Journel, *GSLIB* (1998), section II.1.
"""

from __future__ import annotations

import re
from pathlib import Path

from .dialect import FileHeader

_NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?")
_BEGINNING = re.compile(rb"[^\n]*\n[ \t]*(\d{1,2})(?:[ \t]+\d+)*[ \t\r]*\n")


def begins_as_geo_eas(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    if (match := _BEGINNING.match(head)) is None or not 0 < (count := int(match[1])) < 100:
        return False
    lines = head.split(b"\n")[2 : count + 3]
    return len(lines) > count and not any(map(_is_row, lines[:count])) and _is_row(lines[count])


def _is_row(line: bytes) -> bool:
    return bool(line.split()) and all(map(_NUMBER.fullmatch, line.split()))


def geo_eas_header(_file: Path, lines: list[str]) -> FileHeader:
    """The header of its first lines."""
    count = int(lines[1].split()[0])
    return FileHeader(count + 2, tuple(line.strip() for line in lines[2 : count + 2]), 2)
