# SPDX-License-Identifier: GPL-3.0-or-later
"""CPS-3 grids (Schlumberger), text: lines of keys (FS...), then columns from west to east, each from north to
south."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import Gather, in_memory
from ...base.text import Step, no_step, text_content
from .grid_text import GridText, grid_heights, header_numbers, require_count, require_spacing
from .raster import Raster, without_values

_BEGINNING = re.compile(rb"(?:\s*!.*\n)*\s*FS(?:ASCI|ATTR|LIMI|NROW|XINC)\s")
_NO_HEIGHT = 1e30


def is_cps3_grid(head: bytes) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head.replace(b"\r", b"\n")))


def read_cps3_grid(
    file: str | Path, nodata: Sequence[float] = (), step: Step = no_step, gather: Gather = in_memory
) -> Raster:
    """A grid. Raises InputRefused naming the line."""
    file = Path(file)
    raw = text_content(file)
    keys: dict[str, tuple[int, str]] = {}
    at, number = 0, 0
    while at < len(raw):
        end = raw.find(b"\n", at)
        end = len(raw) if end < 0 else end
        text = raw[at:end].decode("latin-1").strip()
        if text and not text.startswith(("FS", "!", "->")):
            break
        number += 1
        at = end + 1
        if text.startswith("FS"):
            keys[text.split()[0]] = (number, text.partition(" ")[2])
    for key in ("FSLIMI", "FSNROW"):
        if key not in keys:
            raise InputRefused(f"the header has no line {key}", file=file, line=max(number, 1))
    line, text = keys["FSNROW"]
    counts = header_numbers(file, text, line, 2, "the numbers of rows and columns")
    rows, columns = (
        require_count(file, counts[0], "rows", line),
        require_count(file, counts[1], "columns", line),
    )
    line, text = keys["FSLIMI"]
    west, east, south, north = header_numbers(file, text, line, 4, "the ends of x and y")
    dx = require_spacing(file, west, east, columns, "x", line)
    dy = require_spacing(file, south, north, rows, "y", line)
    none = _NO_HEIGHT
    if "FSASCI" in keys:
        words = re.findall(r'"[^"]*"|\S+', keys["FSASCI"][1])
        if len(words) > 4:
            (none,) = header_numbers(file, words[4], keys["FSASCI"][0], 1, "the number for no height")
    heights = grid_heights(GridText(file, raw, at, number + 1), rows, columns, step)
    z = gather((without_values(piece, [none, *nodata]) for piece in heights), np.empty(0))
    return Raster(z.reshape(columns, rows).T, (west, north), (dx, 0.0), (0.0, -dy))
