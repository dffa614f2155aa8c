# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids of text in columns from west to east, each from north to south: CPS-3 (Schlumberger), with lines of
keys (FS...), and ZMAP+ (Landmark), with comments (! and +) and a header between two @.

The layouts are those of GDAL's driver ZMap and of xtgeo (`surface/_zmap_parser.py`, `test_zmap_spec.py`)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from ...base.errors import InputRefused
from ...base.mapped_arrays import JoinPieces, in_memory
from ...base.text import BYTES_AT_ONCE, Content, Step, no_step, text_content
from .grid_text import (
    NO_HEIGHT_WORDS,
    GridText,
    grid_heights,
    header_lines,
    header_numbers,
    require_count,
    require_spacing,
)
from .raster import Raster, known_heights

_CPS3 = re.compile(rb"(?:\s*!.*\n)*\s*FS(?:ASCI|ATTR|LIMI|NROW|XINC)\s")
_ZMAP = re.compile(rb"(?:\s*[!+].*\n)*\s*@[^\n]*,\s*GRID\s*,", re.IGNORECASE)
_NO_HEIGHT = 1e30  # of CPS-3


def is_cps3_grid(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_CPS3.match(head.replace(b"\r", b"\n")))


def is_zmap_grid(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_ZMAP.match(head.replace(b"\r", b"\n")))


def read_cps3_grid(
    file: str | Path, nodata: Sequence[float] = (), step: Step = no_step, gather: JoinPieces = in_memory
) -> Raster:
    """A grid. Raises InputRefused naming the line."""
    file = Path(file)
    raw = text_content(file)
    keys: dict[str, tuple[int, str]] = {}
    at, line = 0, 0
    for number, text, end in header_lines(raw):
        if text and not text.startswith(("FS", "!", "->")):
            break
        at, line = end, number
        if text.startswith("FS"):
            keys[text.split()[0]] = number, text.partition(" ")[2]
    for key in ("FSLIMI", "FSNROW"):
        if key not in keys:
            raise InputRefused(f"the header has no line {key}", file=file, line=max(line, 1))
    of_none, text = keys.get("FSASCI", (0, ""))
    words, none = re.findall(r'"[^"]*"|\S+', text), [_NO_HEIGHT]
    if len(words) > 4:
        none = header_numbers(file, words[4], of_none, 1, "the number for no elevation")
    (first, counts), (second, ends) = keys["FSNROW"], keys["FSLIMI"]
    numbers = header_numbers(file, counts, first, 2, "the numbers of rows and columns")
    numbers += header_numbers(file, ends, second, 4, "the ends of x and y")
    heights = GridText(file, raw, at, line + 1)
    return _columns(heights, numbers, (first, second), [*none, *nodata], step, gather)


def read_zmap_grid(
    file: str | Path, nodata: Sequence[float] = (), step: Step = no_step, gather: JoinPieces = in_memory
) -> Raster:
    """A grid. Raises InputRefused naming the line."""
    file = Path(file)
    raw = text_content(file)
    header: list[tuple[int, str]] = []  # (line, text) from the first @ to the second
    line, at, by_gdal = 0, 0, False
    for line, text, at in header_lines(raw):  # noqa: B007  they say where the heights begin
        if text.startswith("@") and header:
            break
        by_gdal = by_gdal or (text.startswith("!") and "created by gdal" in text.lower())
        if text and not text.startswith(("!", "+")):
            header.append((line, text))
    else:
        raise InputRefused("the header has no second @", file=file, line=line, advice="the file is cut off")
    if len(header) < 3:
        raise InputRefused("the header needs three lines between the two @", file=file, line=line)
    (_, _), (of_none, text), (of_numbers, numbers), *_ = header
    null = text.split(",")[1].strip() if text.count(",") else ""
    none = []
    if null.lower() not in NO_HEIGHT_WORDS:
        none = header_numbers(file, null, of_none, 1, "the number for no elevation")
    layout = header_numbers(file, numbers, of_numbers, 6, "rows, columns, and the ends of x and y")
    if by_gdal:  # which takes the edges of its pixels for the ends
        for low, count in ((2, layout[1]), (4, layout[0])):
            half = (layout[low + 1] - layout[low]) / max(count, 1.0) / 2
            layout[low], layout[low + 1] = layout[low] + half, layout[low + 1] - half
    heights = GridText(file, raw, at, line + 1, comments=_comments(raw, at))
    return _columns(heights, layout, (of_numbers, of_numbers), [*none, *nodata], step, gather)


def _comments(raw: Content, begin: int) -> bytes:
    """The signs that begin comments among the heights; a plus is also one of a number."""
    has_plus = re.search(rb"(?m)^[ \t]*\+(?![\d.])", raw[begin : begin + BYTES_AT_ONCE])
    return b"!+" if has_plus else b"!" if raw.find(b"!", begin) >= 0 else b""


def _columns(
    text: GridText,
    numbers: Sequence[float],
    lines: tuple[int, int],
    none: Sequence[float],
    step: Step,
    gather: JoinPieces,
) -> Raster:
    """numbers: rows, columns, west, east, south, north. lines: of the first two, and of the others."""
    west, east, south, north = numbers[2:]
    rows = require_count(text.file, numbers[0], "rows", lines[0])
    columns = require_count(text.file, numbers[1], "columns", lines[0])
    dx = require_spacing(text.file, west, east, columns, "x", lines[1])
    dy = require_spacing(text.file, south, north, rows, "y", lines[1])
    z = known_heights(grid_heights(text, rows, columns, step), none, gather)
    return Raster(z.reshape(columns, rows).T, (west, north), (dx, 0.0), (0.0, -dy))
