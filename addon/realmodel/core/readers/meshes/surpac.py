# SPDX-License-Identifier: GPL-3.0-or-later
"""GEOVIA Surpac as text: strings (.str), a record with number, northing, easting, elevation for each point,
and triangles of them (.dtm), which name the points of the string file beside it by their numbers from 1
("Surpac file formats: string files, DTM files"; two open readers of them agree)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import FileBytes, Step, no_step, read_text
from ..objects.geo_object import LINES, ObjectName, point_object
from .triangle_mesh import surface_object

_FIRST = 2  # records of the header
_MARK = "TRISOLATION"
_DATED = re.compile(rb"[^,]*,\s*\d{1,4}[-/. ](?:[A-Za-z]{3}|\d{1,2})[-/. ]\d{2,4}\s*,")
_NUMBER = re.compile(rb"\s*[+-]?\d+(?:\.\d*)?\s*")


def begins_as_dtm(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so has triangles."""
    return _MARK.encode() in head and b"\0" not in head


def read_dtm(file: str | Path, _step: Step = no_step) -> list[ObjectName]:
    """The sets of triangles of a .dtm: of one, by the name of the file, of several, by their numbers and
    those of their objects. Raises InputRefused naming file and line."""
    file = Path(file)
    if b"\0" in FileBytes(file)[:4096]:
        raise InputRefused("a binary .dtm of Surpac is not read", file=file, advice="save it as text (ASCII)")
    places = np.array([place for _, _, place in _records(_strings_of(file))]).reshape(-1, 3)
    sets: dict[str, list[list[int]]] = {}
    lines: dict[str, list[int]] = {}
    label, name = "", ""
    for number, words in _rows(file):
        if words[0] == "OBJECT":
            label = words[1] if len(words) > 1 else ""
        elif words[0] == _MARK:
            name = f"object {label}, trisolation {words[1] if len(words) > 1 else ''}"
        elif name and words[0] not in ("END", "0") and len(words) > 3:
            try:
                corners = [int(word) - 1 for word in words[1:4]]
            except ValueError as error:
                what = f"'{', '.join(words):.40}' is no triangle"
                raise InputRefused(what, file=file, line=number) from error
            sets.setdefault(name, []).append(corners)
            lines.setdefault(name, []).append(number)
    if not sets:
        raise InputRefused("it has no triangles", file=file)
    names = list(sets) if len(sets) > 1 else [file.stem]
    return [
        surface_object(file, shown, places, faces, lines[name])
        for shown, (name, faces) in zip(names, sets.items(), strict=True)
    ]


def begins_as_str(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so has strings: its first record has a name and a date, or names their
    styles; the second is 0 and an axis, two places, or only zeros."""
    first, _, second = head.partition(b"\n")
    axis = second.partition(b"\n")[0].strip().rstrip(b",").split(b",")
    is_axis = len(axis) == 7 and axis[0].strip() == b"0" and all(map(_NUMBER.fullmatch, axis))
    return b"ssi_styles:" in first.lower() or (is_axis and _DATED.match(first) is not None)


def read_str(file: str | Path, _step: Step = no_step) -> list[ObjectName]:
    """The points of the strings, by their numbers. Raises InputRefused naming file and line."""
    file = Path(file)
    strings: dict[str, list[tuple[float, ...]]] = {}
    for _, number, place in _records(file):
        strings.setdefault(number, []).append(place)
    if not strings:
        raise InputRefused("it has no points", file=file)
    return [point_object(number, places, LINES) for number, places in strings.items()]


def _strings_of(file: Path) -> Path:
    """The string file of a .dtm: the one beside it, or the one that it names."""
    said = Path(next((words[0] for _, words in _rows(file)), "").replace("\\", "/")).name
    beside = [file.with_suffix(ending) for ending in (".str", ".STR", ".Str")]
    for path in (*beside, file.with_name(said or file.name)):
        if path != file and path.is_file():
            return path
    what = f"its points are in the string file '{beside[0].name}', which is not beside it"
    raise InputRefused(what, file=file, advice="put both files into one folder")


def _rows(file: Path) -> Iterator[tuple[int, list[str]]]:
    for number, line in enumerate(read_text(file).split("\n"), 1):
        if line.strip(" ,\t"):
            yield number, [word.strip() for word in line.split(",")]


def _records(file: Path) -> Iterator[tuple[int, str, tuple[float, float, float]]]:
    """The line, the number of the string and the place (x, y, z) of each point; records of 0 end strings."""
    for number, words in list(_rows(file))[_FIRST:]:
        if words[-1] == "END" or words[0].upper() == "END":
            return
        if words[0] in ("0", "0.000"):
            continue
        try:
            north, east, up = (float(word) for word in words[1:4])
        except ValueError as error:
            what = f"'{', '.join(words):.40}' is no point: number, northing, easting, elevation"
            raise InputRefused(what, file=file, line=number) from error
        yield number, words[0], (east, north, up)
