# SPDX-License-Identifier: GPL-3.0-or-later
"""Wireframes of Datamine: two tables, points (PID, XP, YP, ZP) and triangles (PID1, PID2, PID3), as text or
in the binary format .dm of single or extended precision (the layout is public by the open readers pygslib and
dmfile: pages of 512 words, of which the first has the fields)."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, no_step, read_bytes, read_text
from ..objects.geo_object import ObjectName, point_object
from .triangle_mesh import UNREADABLE, surface_object, unreadable

_CORNERS, _PLACE = ("PID1", "PID2", "PID3"), ("XP", "YP", "ZP")
_WORDS, _USED = 512, 508  # of a page, and those that have records
_MISSING = 9.9e29  # values beyond it say nothing
_KINDS = (b"N   ", b"A   ")


def begins_as_datamine(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is a table of a wireframe, binary or text."""
    if _word_size(head):
        return True
    names = re.split(rb'[,;\t "]+', head.partition(b"\n")[0].strip().upper())
    wanted = [name.encode() for name in _CORNERS], [b"PID", *(name.encode() for name in _PLACE)]
    return any(set(some) <= set(names) for some in wanted)


def read_datamine(file: str | Path, _step: Step = no_step) -> list[ObjectName]:
    """The surface of a table of triangles and the table of points beside it, either of which is named; or the
    points alone. It is called as the file. Raises InputRefused."""
    file = Path(file)
    table = _table(file)
    if set(_CORNERS) <= table.keys():
        triangle_file, triangles, point_file = file, table, _beside(file, "tr", "pt")
        if point_file is None:
            what = "its points are in another table (pt), which is not beside it"
            raise InputRefused(what, file=file, advice="put the two files of a wireframe into one folder")
        points = _table(point_file)
    elif {"PID", *_PLACE} <= table.keys():
        points, other_file = table, _beside(file, "pt", "tr")
        places = np.column_stack([points[name] for name in _PLACE])
        if other_file is None:
            return [point_object(file.stem, places)]
        triangle_file, triangles = other_file, _table(other_file)
    else:
        what = f"its fields are {', '.join(table)}: it is no table of a wireframe"
        raise InputRefused(what, file=file, advice="export it as text (.csv) or as DXF")
    try:
        numbers, places = points["PID"], np.column_stack([points[name] for name in _PLACE])
        corners = np.column_stack([triangles[name] for name in _CORNERS])
    except KeyError as error:
        raise InputRefused(f"the other table of its wireframe has no field {error}", file=file) from error
    order = np.argsort(numbers, kind="stable")
    at = order[np.minimum(np.searchsorted(numbers[order], corners), len(order) - 1)]
    if len(numbers) == 0 or (numbers[at] != corners).any():
        raise InputRefused("a triangle has a point that is not in the table of points", file=triangle_file)
    return [surface_object(file, _wireframe(file), places, at)]


def _wireframe(file: Path) -> str:
    """The name of a wireframe: that of its file without pt or tr."""
    return re.sub(r"[_\- ]?(?:pt|tr)$|^(?:pt|tr)[_\- ]?", "", file.stem, flags=re.IGNORECASE) or file.stem


def _beside(file: Path, has: str, other: str) -> Path | None:
    """The other file of a wireframe, which is named alike."""
    stem = file.stem.lower()
    names = {stem.removesuffix(has) + other, other + stem.removeprefix(has)}
    names = {name for name in names if len(name) == len(stem) and name != stem}
    for path in sorted(file.parent.iterdir()):
        if path.stem.lower() in names and path.suffix.lower() == file.suffix.lower():
            return path
    return None


def _table(file: Path) -> dict[str, np.ndarray]:
    """The numbers (N,) of each field by its name, without fields of text. Raises InputRefused."""
    raw = read_bytes(file)
    try:
        size = _word_size(raw)
        return _binary_table(raw, size) if size else _text_table(file)
    except InputRefused:
        raise
    except UNREADABLE as error:
        raise unreadable(file, "Datamine", error) from error


def _text_table(file: Path) -> dict[str, np.ndarray]:
    head, *lines = [line for line in read_text(file).split("\n") if line.strip()]
    sign = next((sign for sign in ",;\t" if sign in head), None)
    names = [name.strip(' "').upper() for name in head.split(sign)]
    wanted = [name for name in names if name in ("PID", *_PLACE, *_CORNERS)]
    rows = [line.split(sign) for line in lines]
    return {name: np.array([float(row[names.index(name)].strip(' "')) for row in rows]) for name in wanted}


def _word_size(raw: bytes) -> int:
    """4 of single precision, 8 of extended; 0: it is no binary file. The first field, behind the head of 28
    words, has its type in its third word, or its fifth half."""
    for size in (4, 8):
        kind = raw[28 * size + 2 * size :][:4]
        if len(raw) >= 32 * size and kind in _KINDS and 1 <= _numbers(raw, size, 25 * size)[0] <= 500:
            return size
    return 0


def _numbers(raw: bytes, size: int, at: int, count: int = 1) -> np.ndarray:
    return np.frombuffer(raw, f"<f{size}", count, at).astype(np.float64)


def _binary_table(raw: bytes, size: int) -> dict[str, np.ndarray]:
    """The fields: each has a name in two words, its type, where it is stored in a record (0: it is the same
    in all), its word of a text, and that value. Raises ValueError."""
    fields, last_page, last_rows = (int(value) for value in _numbers(raw, size, 25 * size, 3))
    names, stored, same, words = [], [], [], 0
    for number in range(fields):
        at = (28 + 7 * number) * size
        name = raw[at : at + 4] + raw[at + size : at + size + 4]
        word, _, _, value = _numbers(raw, size, at + 3 * size, 4)
        is_number = raw[at + 2 * size : at + 2 * size + 4] == _KINDS[0]
        words = max(words, int(word))
        names.append(name.decode("latin-1").strip().upper() if is_number else "")
        stored.append(int(word) - 1)
        same.append(value)
    per_page = _USED // max(words, 1)
    pages = []
    for page in range(1, last_page):
        count = per_page if page < last_page - 1 else last_rows
        begin = page * _WORDS * size
        if not 0 <= count <= per_page or begin + count * words * size > len(raw):
            raise ValueError(f"the file is cut off at byte {len(raw)}")
        pages.append(_numbers(raw, size, begin, count * words).reshape(count, words))
    rows = np.concatenate([np.empty((0, words)), *pages])
    table = {
        name: rows[:, at] if at >= 0 else np.full(len(rows), value)
        for name, at, value in zip(names, stored, same, strict=True)
        if name
    }
    return {name: np.where(np.abs(column) < _MISSING, column, np.nan) for name, column in table.items()}
