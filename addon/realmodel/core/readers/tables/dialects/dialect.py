# SPDX-License-Identifier: GPL-3.0-or-later
"""A kind of table of text with a special header."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

_UNIT = re.compile(r"(.*?(?:\b|_)units?(?![a-z])[^:=>]*)(?:[:=]|->)\s*(\S.*?)\s*$", re.IGNORECASE)
_PLAN = re.compile(r"(?:\b|_)(?:x|y|xy|horizontal|lateral|plan|easting|northing)(?:\b|_)", re.IGNORECASE)
_HEIGHT = re.compile(r"(?:\b|_)(?:z|depth|vertical|elevation|height|altitude)(?:\b|_)", re.IGNORECASE)


@dataclass(frozen=True)
class FileHeader:
    """rows: the line, from 0, where the rows begin. names, name_line, units, nodata: as of a TableLayout,
    lines from 0."""

    rows: int
    names: tuple[str, ...] | None
    name_line: int | None = None
    units: tuple[str, str] = ("", "")
    nodata: float | None = None


@dataclass(frozen=True)
class Dialect:
    """A kind of table, recognized by its beginning: begins(head, size), as of a FileFormat. header(file,
    lines): of its first lines; raises InputRefused. not_rows: lines among its rows that are none."""

    label: str
    endings: tuple[str, ...]
    begins: Callable[[bytes, int], bool]
    header: Callable[[Path, list[str]], FileHeader]
    not_rows: re.Pattern[bytes] | None = None


def comment_units(comments: Iterable[str]) -> tuple[str, str]:
    """The texts that comments give for the unit of x and y, and for that of z: "# Units: m", "# Unit in
    depth: ft", "# Z_units: ft"; "" where they say nothing."""
    plan = height = every = ""
    for comment in comments:
        if not (match := _UNIT.match(comment)):
            continue
        what, unit = match.groups()
        if _PLAN.search(what):
            plan = unit
        if _HEIGHT.search(what):
            height = unit
        if not (_PLAN.search(what) or _HEIGHT.search(what)):
            every = unit
    return plan or every, height or every
