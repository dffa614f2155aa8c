# SPDX-License-Identifier: GPL-3.0-or-later
"""Petrel's points with attributes and well tops: comments, VERSION, the names of columns between BEGIN
HEADER and END HEADER, each on its line with its type before it, then rows with blanks between them and
texts in quotes.

The layout is that of gemgis (`raster.py`, which writes it) and of files in OpenGeoSys (ufz/ogs#3016).
"""

from __future__ import annotations

import re
from pathlib import Path

from ....base.errors import InputRefused
from .dialect import FileHeader, comment_units

_BEGINNING = re.compile(rb"^\s*BEGIN HEADER\s*$", re.MULTILINE | re.IGNORECASE)
_TYPE = re.compile(r"(?:FLOAT|INT|INTEGER|DOUBLE|STRING|BOOL|BOOLEAN|DATETIME|DATE)\s*,\s*", re.IGNORECASE)
NO_VALUE = -999.0


def begins_as_petrel(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.search(head[:4096].replace(b"\r", b"\n")))


def petrel_header(file: Path, lines: list[str]) -> FileHeader:
    """The header of its first lines. Raises InputRefused where it has no end."""
    marks = {line.strip().upper(): n for n, line in reversed(list(enumerate(lines)))}
    first, end = marks["BEGIN HEADER"], marks.get("END HEADER")
    if end is None:
        raise InputRefused("the header has no line END HEADER", file=file, line=first + 1)
    names = [_TYPE.sub("", line.strip(), count=1).strip('"') for line in lines[first + 1 : end]]
    return FileHeader(end + 1, tuple(filter(None, names)), first + 1, comment_units(lines[:first]), NO_VALUE)
