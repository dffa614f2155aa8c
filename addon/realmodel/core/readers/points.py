# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattered points from text: CSV and its kin, with or without a header, and plain .xyz."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from ..errors import InputRefused
from .text import LINES_AT_ONCE, NOT_FINITE, NUMBER, Step, column_numbers, no_step, read_text

_NAMES = ("x", "y", "z")


def read_points(file: str | Path, step: Step = no_step) -> np.ndarray:
    """(P, 3) float64 points of a text file, in its order.

    The values of a line stand apart by semicolons, tabs, commas or blanks (in this order of
    preference, told from the first line). A first line without numbers is a header; where it has
    columns X, Y and Z (any case) they are taken, otherwise the first three. '#' begins a comment.
    Further columns are ignored. Raises InputRefused naming file and line.
    step(fraction) is called at least every 20,000 lines; what it raises passes through.
    """
    file = Path(file)
    lines = read_text(file).split("\n")
    first = next((n for n, line in enumerate(lines) if _content(line)), None)
    if first is None:
        raise InputRefused("there are no points in it", file=file)
    delimiter = next((mark for mark in ";\t," if len(_fields(lines[first], mark)) >= 3), None)
    columns = _header_columns(file, first + 1, _fields(lines[first], delimiter))
    body = lines[first if columns is None else first + 1 :]
    skipped = len(lines) - len(body)
    columns = columns or (0, 1, 2)
    try:
        points = column_numbers(body, columns, delimiter, np.float64, step)
    except ValueError:
        points = None
    if points is None or not np.isfinite(points).all():
        points = _line_by_line(file, body, skipped, columns, delimiter, step)
    if not len(points):
        raise InputRefused("there are no points in it", file=file)
    return np.ascontiguousarray(points)


def _content(line: str) -> str:
    return line.partition("#")[0].strip(" ")


def _fields(line: str, delimiter: str | None) -> list[str]:
    content = _content(line)
    if delimiter is None:
        return content.split()
    if '"' in content:
        return [entry.strip() for entry in next(csv.reader([content], delimiter=delimiter))]
    return [entry.strip() for entry in content.split(delimiter)]


def _is_numeric(entry: str) -> bool:
    return bool(NUMBER.fullmatch(entry) or NOT_FINITE.fullmatch(entry))


def _header_columns(file: Path, line: int, entries: list[str]) -> tuple[int, int, int] | None:
    """The columns of x, y and z if the first line is a header, None if it is a line of numbers."""
    names = [entry.strip("\"'").lower() for entry in entries]
    found = [names.count(name) for name in _NAMES]
    if not any(found):
        return None if any(_is_numeric(entry) for entry in entries) else (0, 1, 2)
    for name, count in zip(_NAMES, found, strict=True):
        if count != 1:
            what = (
                f"the header has {count} columns named {name}"
                if count
                else f"the header has no column {name}"
            )
            raise InputRefused(what, file=file, line=line, advice="name the columns x, y and z")
    return tuple(names.index(name) for name in _NAMES)


def _line_by_line(file, lines, skipped, columns, delimiter, step: Step) -> np.ndarray:
    """The same points, slowly, stopping at the first line that is not as it must be."""
    points = []
    for number, line in enumerate(lines):
        if number % LINES_AT_ONCE == 0:
            step(number / len(lines))
        if not _content(line):
            continue
        entries = _fields(line, delimiter)

        def refuse(what: str, advice: str | None = None, number=number) -> InputRefused:
            return InputRefused(what, file=file, line=skipped + number + 1, advice=advice)

        if len(entries) <= max(columns):
            raise refuse(f"{max(columns) + 1} values are needed, there are {len(entries)}")
        point = []
        for name, column in zip(_NAMES, columns, strict=True):
            entry = entries[column]
            if NOT_FINITE.fullmatch(entry):
                raise refuse(f"{name} is {entry}, not a finite number", "leave out points without a value")
            if not NUMBER.fullmatch(entry):
                raise refuse(
                    f"{name} is not a number: '{entry}'",
                    "write decimals with a point" if "," in entry else None,
                )
            point.append(float(entry))
        if not np.isfinite(point).all():
            raise refuse("a number is too large")
        points.append(point)
    return np.array(points, np.float64).reshape(-1, 3)
