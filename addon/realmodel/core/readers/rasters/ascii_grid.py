# SPDX-License-Identifier: GPL-3.0-or-later
"""ESRI ASCII grids (.asc): a header of keys, then heights row after row from north to south."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

from ...base.errors import InputRefused
from ...base.mapped_arrays import JoinPieces, in_memory
from ...base.text import BOM, Content, Step, no_step, text_content
from ..tables.table_layout import is_number
from .grid_text import NO_HEIGHT_WORDS, GridText, grid_heights, header_lines
from .raster import Raster, known_heights

_KEYS = (
    "ncols",
    "nrows",
    "xllcorner",
    "yllcorner",
    "xllcenter",
    "yllcenter",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
)
_BEGINNING = re.compile(rb"\s*(?:ncols|nrows)[ \t]", re.IGNORECASE)
_LONGEST_HEADER = 4096


def is_ascii_grid(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head.removeprefix(b"\xef\xbb\xbf")))


def read_ascii_grid(
    file: str | Path, nodata: Sequence[float] = (), step: Step = no_step, gather: JoinPieces = in_memory
) -> Raster:
    """A grid; heights stand at the centers of its cells. nodata: further numbers that mean no height.

    Raises InputRefused naming file and line.
    """
    file = Path(file)
    raw = text_content(file)
    head = raw[:_LONGEST_HEADER]
    decimal = "," if b"," in head and b"." not in head else "."
    header, lines, word, body, body_line = _header(file, raw, decimal)
    columns, rows = (_count(file, header, lines, key) for key in ("ncols", "nrows"))
    size = header.get("cellsize")
    dx, dy = header.get("dx", size), header.get("dy", size)
    if dx is None or dy is None or not (dx > 0 and dy > 0):
        line = lines.get("cellsize")
        raise InputRefused("the header needs a cellsize above 0", file=file, line=line)
    west = _lower_left(file, header, "x", dx)
    south = _lower_left(file, header, "y", dy)
    heights = grid_heights(GridText(file, raw, body, body_line, decimal, word), rows, columns, step)
    none = [header["nodata_value"]] if "nodata_value" in header else []
    z = known_heights(heights, [*none, *nodata], gather)
    return Raster(z.reshape(rows, columns), (west, south + (rows - 1) * dy), (dx, 0.0), (0.0, -dy))


def _header(file: Path, raw: Content, decimal: str) -> tuple[dict, dict, str, int, int]:
    """The keys' numbers and lines, the word that means no height, the byte where the heights begin, and the
    line of that."""
    header, lines, none = {}, {}, ""
    at, number = 0, 0
    for number, text, end in header_lines(raw):
        entries = text.removeprefix(BOM.decode("latin-1")).split()
        if entries and (not entries[0][0].isalpha() or entries[0].lower() in (*NO_HEIGHT_WORDS, none)):
            break
        at = end
        if not entries:
            continue
        key = entries[0].lower()
        if key not in _KEYS:
            what = f"the header has an unknown key '{entries[0]:.20}'"
            raise InputRefused(what, file=file, line=number, advice=f"known are {', '.join(_KEYS)}")
        if key == "nodata_value" and len(entries) == 2 and not is_number(entries[1], decimal):
            none = entries[1].lower()
            continue
        if len(entries) != 2 or not is_number(entries[1], decimal):
            raise InputRefused(f"{entries[0]} needs one number", file=file, line=number)
        header[key] = float(entries[1].replace(",", "."))
        if not math.isfinite(header[key]) and key != "nodata_value":
            raise InputRefused(f"{entries[0]} is not finite", file=file, line=number)
        lines[key] = number
    return header, lines, none, at, max(number, 1)


def _count(file: Path, header: dict, lines: dict, key: str) -> int:
    value = header.get(key)
    if value is None:
        raise InputRefused(f"the header has no {key}", file=file)
    if not (value >= 1 and value == int(value)):
        raise InputRefused(f"{key} must be a whole number from 1", file=file, line=lines[key])
    return int(value)


def _lower_left(file: Path, header: dict, axis: str, size: float) -> float:
    """The coordinate of the center of the cell in the south-west."""
    if f"{axis}llcenter" in header:
        return header[f"{axis}llcenter"]
    if f"{axis}llcorner" in header:
        return header[f"{axis}llcorner"] + 0.5 * size
    raise InputRefused(f"the header has neither {axis}llcorner nor {axis}llcenter", file=file)
