# SPDX-License-Identifier: GPL-3.0-or-later
"""Geosoft's XYZ: comments that begin with / and of which the last names the columns, lines such as "Line 10"
before the rows of each, * where there is no value.

The layout is that of Geosoft's public description ("ASCII XYZ data", Oasis montaj).
"""

from __future__ import annotations

import re
from pathlib import Path

from .dialect import FileHeader, comment_units

_LINE = rb"(?:line|tie|base|test|trend|special|random)\b[ \t]*[\w.:]*[ \t\r]*$"
_BEGINNING = re.compile(rb"(?:\s*/[^/][^\n]*\n|\s*\n)*[ \t]*" + _LINE, re.IGNORECASE | re.MULTILINE)
NOT_ROWS = re.compile(rb"(?im)^[ \t]*(?=" + _LINE + rb")|^[ \t]*(?=/)")


def begins_as_geosoft(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head))


def geosoft_header(_file: Path, lines: list[str]) -> FileHeader:
    """The header of its first lines, in which # stands before those that are no rows."""
    first = next((n for n, line in enumerate(lines) if line.strip() and line.lstrip()[0] not in "#/"), 0)
    count = len(lines[first].split())
    comments = [line.lstrip("#/ ").strip() for line in lines[:first]]
    named = [(n, text.split()) for n, text in enumerate(comments) if len(text.split()) == count]
    named = [(n, names) for n, names in named if {"X", "Y"} <= {name.upper() for name in names}]
    at, names = named[-1] if named else (None, None)
    return FileHeader(first, None if names is None else tuple(names), at, comment_units(comments))
