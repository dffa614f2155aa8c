# SPDX-License-Identifier: GPL-3.0-or-later
"""Fault sticks from files of polylines: x y z in each line, and 999 999 999 ends a stick; and those of
Charisma as Petrel writes them: rows of INLINE-, two numbers, x, y, z, the name of the fault and the number of
the stick (gio, resqpy and seismiqb read or write them so)."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import LINES_AT_ONCE, Step, no_step, read_text
from ..objects.geo_object import LINES, STICK, ObjectName, point_object
from .dialects.charisma import LINES_OF_SURVEY

_END_OF_STICK = 999.0  # in all three columns
_END_LINE = re.compile(rb"^\s*(?:999(?:\.0*)?\s+){2}999(?:\.0*)?\s*$", re.MULTILINE)
_CHARISMA = re.compile(
    rf"\s*{LINES_OF_SURVEY}((?:\s+[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?){{3}})(?:\s+(\S.*?))?\s+(\d+)\s*",
    re.IGNORECASE,
)


def begins_as_sticks(head: bytes, _size: int = 0) -> bool:
    """Whether a stick ends in the beginning of a file."""
    return _END_LINE.search(head) is not None


def read_sticks(file: Path, step: Step = no_step) -> list[np.ndarray]:
    sticks: list[list[list[float]]] = []
    points: list[list[float]] = []
    lines = read_text(file).split("\n")
    for number, line in enumerate(lines, 1):
        if number % LINES_AT_ONCE == 0:
            step(number / len(lines))
        words = line.partition("#")[0].split()
        if not words:
            continue
        try:
            point = [float(word) for word in words[:3]]
        except ValueError:
            raise InputRefused(f"'{line.strip():.40}' cannot be read", file=file, line=number) from None
        if len(point) < 3:
            raise InputRefused(f"3 values are needed, there are {len(point)}", file=file, line=number)
        if not np.isfinite(point).all():
            raise InputRefused("a coordinate is not finite", file=file, line=number)
        if all(value == _END_OF_STICK for value in point):
            sticks.append(points)
            points = []
        else:
            points.append(point)
    with_points = [np.array(stick) for stick in (*sticks, points) if stick]
    if not with_points:
        raise InputRefused("there are no points in it", file=file)
    return with_points


def begins_as_charisma_sticks(head: bytes, _size: int = 0) -> bool:
    """Whether the first line of a file is a point of a stick."""
    return _charisma_point(head.strip().partition(b"\n")[0].decode("latin-1")) is not None


def read_charisma_sticks(file: str | Path, _step: Step = no_step) -> list[ObjectName]:
    """The sticks of each fault, by its name or else that of the file. Raises InputRefused naming the line."""
    file = Path(file)
    faults: dict[str, list[tuple[list[float], int]]] = {}
    for number, line in enumerate(read_text(file).split("\n"), 1):
        row = _charisma_point(line)
        if row is not None:
            place = [float(word) for word in row[1].split()]
            faults.setdefault(row[2] or file.stem, []).append((place, int(row[3])))
        elif line.strip() and not line.lstrip().startswith("#"):
            what = f"'{line.strip():.60}' is no point of a stick"
            advice = "write INLINE-, two numbers, x, y, z, the name of the fault, the number of the stick"
            raise InputRefused(what, file=file, line=number, advice=advice)
    return [
        point_object(name, [place for place, _ in points], LINES, {STICK: np.array([n for _, n in points])})
        for name, points in faults.items()
    ]


def _charisma_point(line: str) -> re.Match[str] | None:
    """A row of a stick. One of a horizon names both lines, and has at most numbers behind its place."""
    row = _CHARISMA.fullmatch(line)
    names_both = row is not None and "LINE" in row[0].upper().partition("LINE")[2]
    return row if row and (not names_both or re.search(r"[^-+.\dEe]", row[2] or "")) else None
