# SPDX-License-Identifier: GPL-3.0-or-later
"""RMS' points with attributes: a line with the type and the name of each attribute, then rows of x, y, z
and these, UNDEF where there is none.

The layout is that of xtgeo (`xyz_common` and `_xyz_io.py`: format "rms_attr").
"""

from __future__ import annotations

import re
from pathlib import Path

from .dialect import FileHeader

_TYPED = re.compile(r"\s*(?:Discrete|String|Int|Float)\s+(\S.*?)\s*$")


def begins_as_rms(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_TYPED.match(head.partition(b"\n")[0].decode("latin-1")))


def rms_header(_file: Path, lines: list[str]) -> FileHeader:
    """The header of its first lines."""
    names = []
    for line in lines:
        if not (match := _TYPED.match(line)):
            break
        names.append(match[1])
    return FileHeader(len(names), ("X", "Y", "Z", *names), 0)
