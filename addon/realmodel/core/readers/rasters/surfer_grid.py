# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfer's grids (Golden Software): 6 as text (DSAA) and binary (DSBB), 7 binary (DSRB)."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import ROWS_AT_ONCE, JoinPieces, in_memory
from ...base.text import FileBytes, Step, as_utf8, no_step, text_content
from .grid_text import GridText, grid_heights, header_numbers, require_count, require_spacing
from .raster import Raster, known_heights

_BLANK = 1.70141e38  # this, and more, is no height
_HEAD_6 = struct.Struct("<4s2h6d")
_HEAD_TEXT = re.compile(rb"DSAA" + rb"[\s,]+([^\s,]+)" * 8 + rb"[\s,]+")  # on lines of any length
_LONGEST_HEAD = 4096  # bytes
_GRID_7 = struct.Struct("<2i8d")


def is_surfer_grid(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return head[:4] in (b"DSAA", b"DSBB", b"DSRB")


def read_surfer_grid(
    file: str | Path, nodata: Sequence[float] = (), step: Step = no_step, gather: JoinPieces = in_memory
) -> Raster:
    """A grid; its rows go from south to north. Raises InputRefused naming the line or the byte."""
    file = Path(file)
    kind = as_utf8(FileBytes(file)[:64])[:4]
    read = {b"DSAA": _text, b"DSBB": _binary_6, b"DSRB": _binary_7}[kind]
    heights, shape, none, (west, south), (dx, dy) = read(file, step)
    z = known_heights(heights, [*none, *nodata], gather, _BLANK)
    step(1.0)
    return Raster(z.reshape(shape), (west, south), (dx, 0.0), (0.0, dy))


def _text(file: Path, step: Step) -> tuple:
    raw = text_content(file)
    head = _HEAD_TEXT.match(raw[:_LONGEST_HEAD])
    if head is None:
        what = "the header is cut off: it has the numbers of columns and rows, and the ends of x, y and z"
        raise InputRefused(what, file=file)
    pairs = [
        (f"{head[n].decode('latin-1')} {head[n + 1].decode('latin-1')}", head.start(n)) for n in (1, 3, 5)
    ]
    (counts, of_counts), (of_x, at_x), (of_y, at_y) = [
        (text, 1 + raw.count(b"\n", 0, at)) for text, at in pairs
    ]
    columns, rows = header_numbers(file, counts, of_counts, 2, "the numbers of columns and rows")
    columns = require_count(file, columns, "columns", of_counts)
    rows = require_count(file, rows, "rows", of_counts)
    x = header_numbers(file, of_x, at_x, 2, "the lowest and highest x")
    y = header_numbers(file, of_y, at_y, 2, "the lowest and highest y")
    dx = require_spacing(file, x[0], x[1], columns, "x", at_x)
    dy = require_spacing(file, y[0], y[1], rows, "y", at_y)
    heights = grid_heights(
        GridText(file, raw, head.end(), 1 + raw.count(b"\n", 0, head.end())), rows, columns, step
    )
    return heights, (rows, columns), [], (x[0], y[0]), (dx, dy)


def _binary_6(file: Path, _step: Step) -> tuple:
    raw = FileBytes(file)
    if len(raw) < _HEAD_6.size:
        raise InputRefused(f"the header is cut off at byte {len(raw)}", file=file)
    _, columns, rows, west, east, south, north, _, _ = _HEAD_6.unpack(raw[: _HEAD_6.size])
    columns, rows = require_count(file, columns, "columns"), require_count(file, rows, "rows")
    _finite(file, [west, east, south, north], 8)
    spacing = require_spacing(file, west, east, columns, "x"), require_spacing(file, south, north, rows, "y")
    heights = _values(file, raw, _HEAD_6.size, "<f4", columns, rows)
    return heights, (rows, columns), [], (west, south), spacing


def _binary_7(file: Path, _step: Step) -> tuple:
    raw = FileBytes(file)
    sections: dict[bytes, tuple[int, int]] = {}
    at = 0
    while at + 8 <= len(raw):
        size = int.from_bytes(raw[at + 4 : at + 8], "little")
        sections.setdefault(raw[at : at + 4], (at + 8, size))
        at += 8 + size
    if b"GRID" not in sections or sections[b"GRID"][0] + _GRID_7.size > len(raw):
        raise InputRefused(f"it has no section GRID, or is cut off in it at byte {len(raw)}", file=file)
    at = sections[b"GRID"][0]
    rows, columns, *numbers = _GRID_7.unpack(raw[at : at + _GRID_7.size])
    columns, rows = require_count(file, columns, "columns"), require_count(file, rows, "rows")
    west, south, dx, dy, _, _, rotation, blank = numbers
    _finite(file, (west, south, dx, dy), at)
    if rotation:
        raise InputRefused(
            "a rotated grid is not supported", file=file, advice="resample it without rotation"
        )
    if not (dx > 0 and dy > 0):
        raise InputRefused("its cells have no size", file=file)
    if b"DATA" not in sections:
        raise InputRefused("it has no section DATA", file=file, advice="the file is cut off")
    heights = _values(file, raw, sections[b"DATA"][0], "<f8", columns, rows)
    return heights, (rows, columns), [blank], (west, south), (dx, dy)


def _finite(file: Path, numbers: Sequence[float], byte: int) -> None:
    if not np.isfinite(numbers).all():
        raise InputRefused(f"a coordinate of the grid is not finite (byte {byte})", file=file)


def _values(file: Path, raw: FileBytes, at: int, kind: str, columns: int, rows: int) -> Iterator[np.ndarray]:
    size = np.dtype(kind).itemsize
    end = at + columns * rows * size
    if len(raw) < end:
        what = f"{columns} columns and {rows} rows need {end} bytes; there are {len(raw)}"
        raise InputRefused(what, file=file, advice="the file is cut off or its header is wrong")
    for begin in range(at, end, ROWS_AT_ONCE * size):
        piece = raw[begin : min(begin + ROWS_AT_ONCE * size, end)]
        with np.errstate(invalid="ignore"):  # NaN of any kind is no height
            yield np.frombuffer(piece, kind).astype(np.float64)
