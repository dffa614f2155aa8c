# SPDX-License-Identifier: GPL-3.0-or-later
"""Charisma's horizons as Petrel writes them: rows of INLINE : or INLINE-, a number, the same of
XLINE, x, y and z.

The layout is that of examples that users of Petrel publish ("Charisma 3D interpretation lines").
"""

from __future__ import annotations

import re
from pathlib import Path

from .dialect import FileHeader

_ROW = re.compile(rb"\s*INLINE\s*[:-]\s*-?[\d.]+\s+X(?:ROSS)?LINE\s*[:-]\s*-?[\d.]+\s", re.IGNORECASE)
_NUMBER = re.compile(r"-?\d+(?:\.\d*)?")


def begins_as_charisma(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_ROW.match(head))


def charisma_header(_file: Path, lines: list[str]) -> FileHeader:
    """The names of its columns, as blanks part them: words and colons have none."""
    *entries, _, _, _ = lines[0].split()
    names, lines_of = [""] * len(entries), iter(("INLINE", "XLINE"))
    for n, entry in enumerate(entries):
        names[n] = next(lines_of, "") if _NUMBER.fullmatch(entry) else ""
    return FileHeader(0, (*names, "X", "Y", "Z"), None)
