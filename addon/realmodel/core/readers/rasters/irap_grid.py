# SPDX-License-Identifier: GPL-3.0-or-later
"""IRAP classic grids (Roxar), text and binary: rows from south to north, turned by an angle about the first
point."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ...base.algebra import cos, sin
from ...base.errors import InputRefused
from ...base.mapped_arrays import JoinPieces, in_memory
from ...base.text import FileBytes, Step, no_step, text_content
from .grid_text import GridText, grid_heights, header_lines, header_numbers, require_count
from .raster import Raster, known_heights

_MAGIC = -996
_BEGINNING = re.compile(rb"\s*-996(?:\s+[-+.\dEe]+){3}\s*\n")
_NO_HEIGHT = 9999900.0  # this, and more
_HEAD = struct.Struct(">3i6fi")  # record length, magic, ny, ends, steps, record length
_SECOND = struct.Struct(">2i3fi")
_THIRD = 9 * 4


def is_irap_grid(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return head[:8] == struct.pack(">2i", 32, _MAGIC) or bool(_BEGINNING.match(head.replace(b"\r", b"\n")))


def read_irap_grid(
    file: str | Path, nodata: Sequence[float] = (), step: Step = no_step, gather: JoinPieces = in_memory
) -> Raster:
    """A grid. Raises InputRefused naming the line or the byte."""
    file = Path(file)
    with file.open("rb") as opened:
        is_binary = opened.read(4) == struct.pack(">i", 32)
    heights, shape, (west, south), (dx, dy), angle = _binary(file) if is_binary else _text(file, step)
    if not (np.isfinite([west, south, dx, dy, angle]).all() and dx > 0 and dy > 0):
        raise InputRefused("the header has no place for the grid, or no steps above 0", file=file)
    z = known_heights(heights, nodata, gather, _NO_HEIGHT)
    across, up = cos(math.radians(angle)), sin(math.radians(angle))
    step(1.0)
    return Raster(z.reshape(shape), (west, south), (dx * across, dx * up), (-dy * up, dy * across))


def _text(file: Path, step: Step) -> tuple:
    raw = text_content(file)
    numbers: list[float] = []  # the header is 19 of them, on lines of any length
    line, at = 0, 0
    for line, text, at in header_lines(raw):  # noqa: B007  they say where the heights begin
        numbers += header_numbers(file, text, line, len(text.split()), "numbers")
        if len(numbers) > 18:
            break
    else:
        raise InputRefused("the header is cut off: it has 19 numbers", file=file, line=line + 1)
    rows, dx, dy, west, _, south = *numbers[1:4], *numbers[4:7]
    columns, angle = numbers[8], numbers[9]
    columns, rows = require_count(file, columns, "columns"), require_count(file, rows, "rows")
    heights = grid_heights(GridText(file, raw, at, line + 1), rows, columns, step)
    return heights, (rows, columns), (west, south), (dx, dy), angle


def _binary(file: Path) -> tuple:
    raw = FileBytes(file)
    begin = _HEAD.size + _SECOND.size + _THIRD
    if len(raw) < begin:
        raise InputRefused(f"the header is cut off at byte {len(raw)}", file=file)
    _, magic, rows, west, _, south, _, dx, dy, _ = _HEAD.unpack(raw[: _HEAD.size])
    _, columns, angle, _, _, _ = _SECOND.unpack(raw[_HEAD.size : begin - _THIRD])
    if magic != _MAGIC:
        raise InputRefused("not an IRAP grid (byte 4)", file=file)
    columns, rows = require_count(file, columns, "columns"), require_count(file, rows, "rows")
    count = rows * columns
    if len(raw) - begin < 4 * count:
        what = (
            f"{columns} columns and {rows} rows need {begin + 4 * count} bytes and more; there are {len(raw)}"
        )
        raise InputRefused(what, file=file, advice="the file is cut off or its header is wrong")
    return _records(file, raw, begin, rows, columns), (rows, columns), (west, south), (dx, dy), angle


def _records(file: Path, raw: FileBytes, at: int, rows: int, columns: int) -> Iterator[np.ndarray]:
    """The heights, in records of any length from a byte on."""
    have = 0
    while have < rows * columns:
        size = int.from_bytes(raw[at : at + 4], "big")
        is_whole = 0 < size <= len(raw) - at - 8 and not size % 4
        if not is_whole or raw[at + 4 + size : at + 8 + size] != raw[at : at + 4]:
            raise InputRefused(f"a record of the grid is damaged (byte {at})", file=file)
        with np.errstate(invalid="ignore"):  # NaN of any kind is no height
            yield np.frombuffer(raw[at + 4 : at + 4 + size], ">f4").astype(np.float64)
        have += size // 4
        at += size + 8
    if have != rows * columns:
        what = f"{columns} columns and {rows} rows need {rows * columns} elevations; there are {have}"
        raise InputRefused(what, file=file)
