# SPDX-License-Identifier: GPL-3.0-or-later
"""The heights of grids in text files, wherever their lines end."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import BYTES_AT_ONCE, Content, Step
from ...base.work import native_module

_LONGEST = 1 << 10  # bytes of a number, mostly
_BLANK = re.compile(rb"\s")
_OF_NUMBERS = b"0123456789+-.,eE\n"
_LINE_END = re.compile(rb"\n")
NO_HEIGHT_WORDS = ("nan", "-nan", "+nan", "null", "na", "1.#qnan", "-1.#ind")
_NONE = -1.7976931348623157e308  # what such words are read as


@dataclass(frozen=True)
class GridText:
    """The heights of a grid, from byte `body` of its file, on this line, to the end."""

    file: Path
    raw: Content
    body: int
    line: int
    decimal: str = "."
    none: str = ""  # a word that means no height, beside NO_HEIGHT_WORDS
    comments: bytes = b""  # signs that begin a line that is none of heights


def grid_heights(text: GridText, rows: int, columns: int, step: Step) -> Iterator[np.ndarray]:
    """The heights of a grid, piece by piece (N,) float64, NaN where a word says that there is none. Raises
    InputRefused naming the line."""
    native, file, raw, body = native_module(), text.file, text.raw, text.body
    one_a_line = bytes.maketrans(b" \t\r", b"\n\n\n")
    words = "|".join(re.escape(word) for word in (*NO_HEIGHT_WORDS, text.none.lower()) if word)
    no_height = re.compile(rf"(?<!\S)(?:{words})(?!\S)".encode(), re.IGNORECASE)
    as_number = repr(_NONE).encode()
    comment = re.compile(rb"(?m)^[ \t]*[%b][^\n]*" % text.comments) if text.comments else None
    count, at = 0, body
    while at < len(raw):
        chunk = _to_blank(raw, at, _LINE_END if comment else _BLANK)
        if comment is not None and any(sign in chunk for sign in text.comments):
            chunk = comment.sub(lambda match: b" " * len(match[0]), chunk)
        chunk = chunk.translate(one_a_line)
        has_words = chunk.translate(None, _OF_NUMBERS)
        piece = no_height.sub(as_number, chunk) if has_words else chunk
        try:
            numbers = native.read_numbers(piece, (" ", text.decimal), [0], [], ([], []))[0][:, 0]
        except native.InputError as error:
            begin, stop = error.items[2:4]
            entry = piece[begin:stop].decode("latin-1")
            for word in no_height.finditer(chunk):  # back to the bytes of the file
                if word.start() >= begin:
                    break
                begin -= len(as_number) - len(word.group())
            number = text.line + raw.count(b"\n", body, at + begin)
            advice = "write the NODATA_value for missing elevations" if error.kind == "not_finite" else None
            what = f"not an elevation: '{entry:.40}'"
            raise InputRefused(what, file=file, line=number, advice=advice) from error
        at += len(chunk)
        count += len(numbers)
        numbers[numbers == _NONE] = np.nan
        yield numbers
        step(at / len(raw))
    if count != rows * columns:
        raise InputRefused(
            f"{columns} columns and {rows} rows need {rows * columns} elevations; there are {count}",
            file=file,
            advice="the file is cut off or its header is wrong",
        )


def _to_blank(raw: Content, begin: int, end: re.Pattern[bytes]) -> bytes:
    """The text from a byte on, to the end of a number, or of a line."""
    piece = raw[begin : begin + BYTES_AT_ONCE]
    at = begin + len(piece)
    while at < len(raw):
        more = raw[at : at + _LONGEST]
        blank = end.search(more)
        piece += more if blank is None else more[: blank.end()]
        if blank is not None:
            break
        at += len(more)
    return piece


def header_lines(raw: Content) -> Iterator[tuple[int, str, int]]:
    """The number of each line, its text without blanks at its ends, and the byte behind it."""
    at, number = 0, 0
    while at < len(raw):
        end = raw.find(b"\n", at)
        end, number = len(raw) if end < 0 else end, number + 1
        text, at = raw[at:end].decode("latin-1").strip(), min(end + 1, len(raw))
        yield number, text, at


def header_numbers(file: Path, text: str, line: int, count: int, what: str) -> list[float]:
    """The first numbers of a line of a header. Raises InputRefused."""
    words = text.replace(",", " ").split()
    try:
        numbers = [float(word) for word in words[:count]]
        if len(numbers) < count or not np.isfinite(numbers).all():
            raise ValueError
    except ValueError as error:
        raise InputRefused(
            f"the header needs {what} here, not '{text.strip():.60}'", file=file, line=line
        ) from error
    return numbers


def require_count(file: Path, value: float, name: str, line: int | None = None) -> int:
    """A number of rows or columns. Raises InputRefused."""
    if not (1 <= value < 1e9 and value == int(value)):
        raise InputRefused(f"{name} must be a whole number from 1, not {value:g}", file=file, line=line)
    return int(value)


def require_spacing(
    file: Path, low: float, high: float, count: int, axis: str, line: int | None = None
) -> float:
    """The spacing of this number of grid lines between two ends. Raises InputRefused."""
    spacing = (high - low) / (count - 1) if count > 1 else 1.0
    if not (np.isfinite(spacing) and spacing > 0):
        what = f"the grid must go from a lower to a higher {axis}, not from {low:g} to {high:g}"
        raise InputRefused(what, file=file, line=line)
    return spacing
