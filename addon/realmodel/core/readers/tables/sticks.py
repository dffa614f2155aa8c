# SPDX-License-Identifier: GPL-3.0-or-later
"""Fault sticks from files of polylines: x y z in each line, and 999 999 999 ends a stick."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import LINES_AT_ONCE, Step, no_step, read_text

_END_OF_STICK = 999.0  # in all three columns
_END_LINE = re.compile(rb"^\s*(?:999(?:\.0*)?\s+){2}999(?:\.0*)?\s*$", re.MULTILINE)


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
