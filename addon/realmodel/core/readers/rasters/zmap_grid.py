# SPDX-License-Identifier: GPL-3.0-or-later
"""ZMAP+ grids (Landmark), text: comments (!), a header between two @, then columns from west to east, each
from
north to south."""

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

_BEGINNING = re.compile(rb"(?:\s*!.*\n)*\s*@[^\n]*,\s*GRID\s*,", re.IGNORECASE)


def is_zmap_grid(head: bytes) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head.replace(b"\r", b"\n")))


def read_zmap_grid(
    file: str | Path, nodata: Sequence[float] = (), step: Step = no_step, gather: Gather = in_memory
) -> Raster:
    """A grid. Raises InputRefused naming the line."""
    file = Path(file)
    raw = text_content(file)
    header: list[tuple[int, str]] = []  # (line, text) from the first @ to the second
    at, number = 0, 0
    while True:
        end = raw.find(b"\n", at)
        if end < 0:
            raise InputRefused(
                "the header has no second @", file=file, line=number, advice="the file is cut off"
            )
        text, at, number = raw[at:end].decode("latin-1").strip(), end + 1, number + 1
        if text.startswith("@") and header:
            break
        if text and not text.startswith("!"):
            header.append((number, text))
    if len(header) < 3:
        raise InputRefused("the header needs three lines between the two @", file=file, line=number)
    line, text = header[1]
    null = text.split(",")[1].strip() if text.count(",") else ""
    none = header_numbers(file, null, line, 1, "the number for no height")
    line, text = header[2]
    numbers = header_numbers(file, text, line, 6, "rows, columns, and the ends of x and y")
    rows, columns = (
        require_count(file, numbers[0], "rows", line),
        require_count(file, numbers[1], "columns", line),
    )
    west, east, south, north = numbers[2:]
    dx = require_spacing(file, west, east, columns, "x", line)
    dy = require_spacing(file, south, north, rows, "y", line)
    heights = grid_heights(GridText(file, raw, at, number + 1), rows, columns, step)
    z = gather((without_values(piece, [*none, *nodata]) for piece in heights), np.empty(0))
    return Raster(z.reshape(columns, rows).T, (west, north), (dx, 0.0), (0.0, -dy))
