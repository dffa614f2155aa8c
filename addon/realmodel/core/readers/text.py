# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of numbers in text files, read in pieces so that a caller can show progress and stop."""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..errors import InputRefused

NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
LINES_AT_ONCE = 20_000

Step = Callable[[float], None]


def no_step(_fraction: float) -> None:
    """For callers that want no progress."""


def read_bytes(file: Path) -> bytes:
    """What a file holds; text in UTF-16, as spreadsheets write it, as UTF-8. Raises InputRefused."""
    try:
        raw = Path(file).read_bytes()
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file, advice="check the path") from error
    if raw[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        try:
            return raw.decode("utf-16").encode()
        except UnicodeDecodeError as error:
            raise InputRefused("damaged UTF-16 text", file=file, advice="save it as UTF-8") from error
    return raw


def line_of_word(raw: bytes, number: int) -> int:
    """The line, from 1, of a word, from 0; the last line where there are fewer words."""
    for line, text in enumerate(raw.split(b"\n"), 1):
        number -= len(text.split())
        if number < 0:
            return line
    return raw.rstrip().count(b"\n") + 1


def require_text(file: Path, raw: bytes) -> None:
    """Refuses what cannot be text."""
    if b"\0" in raw[:4096]:
        raise InputRefused("this is a binary file, not text", file=file)


def read_text(file: Path) -> str:
    """The text of a file. Numbers are ASCII, so that names in any 8-bit encoding do no harm."""
    raw = read_bytes(file)
    require_text(file, raw)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def column_numbers(
    lines: list[str], columns: tuple[int, ...], delimiter: str | None, dtype, step: Step = no_step
):
    """(N, len(columns)) numbers of the given lines; blank lines and what follows '#' are left out.

    Raises ValueError where NumPy cannot read a line: the caller then looks for it with more patience.
    """
    pieces = []
    for start in range(0, len(lines), LINES_AT_ONCE):
        piece = [line for line in lines[start : start + LINES_AT_ONCE] if line and not line.isspace()]
        if piece and not all(line.lstrip().startswith("#") for line in piece):
            pieces.append(
                np.loadtxt(
                    piece,
                    dtype=dtype,
                    comments="#",
                    delimiter=delimiter,
                    usecols=columns,
                    ndmin=2,
                    quotechar='"',
                )
            )
        step(min(1.0, (start + LINES_AT_ONCE) / len(lines)))
    return np.concatenate(pieces) if pieces else np.empty((0, len(columns)), dtype)
