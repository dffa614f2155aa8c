# SPDX-License-Identifier: GPL-3.0-or-later
"""Charisma's horizons as Petrel writes them: rows of INLINE :, a number, XLINE :, a number, x, y and z;
also INLINE- and INLINE-7.

The layout is that of examples that users of Petrel publish ("Charisma 3D interpretation lines").
"""

from __future__ import annotations

import re
from pathlib import Path

from .dialect import FileHeader

_SURVEY_LINE = r"LINE\s*[-:]?\s*[-+]?[\d.]+"
LINES_OF_SURVEY = rf"IN-?{_SURVEY_LINE}\s+(?:(?:(?:X|CROSS)-?{_SURVEY_LINE})|[\d.]+)"
_ROW = re.compile(rf"\s*{LINES_OF_SURVEY}\s".encode(), re.IGNORECASE)
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")


def begins_as_charisma(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_ROW.match(head))


def charisma_header(_file: Path, lines: list[str]) -> FileHeader:
    """The names of its columns, as blanks part them: words, also INLINE-7, have none."""
    names_of = iter(("INLINE", "XLINE", "X", "Y", "Z"))
    entries = lines[0].split()
    found = [next(names_of, "") if _NUMBER.search(entry) else "" for entry in entries]
    names = (name if _NUMBER.fullmatch(entry) else "" for name, entry in zip(found, entries, strict=True))
    return FileHeader(0, tuple(names), None)
