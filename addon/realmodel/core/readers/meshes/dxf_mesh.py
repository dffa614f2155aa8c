# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces in DXF (text, any release): 3DFACE entities, polyface meshes and polygon meshes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import MakeRows, Rows
from ...base.text import LINES_AT_ONCE, Step, no_step, text_lines
from .shared_vertices import share_vertices
from .triangle_mesh import MeshRows, TriangleMesh

_BEGINNING = re.compile(rb"(?:\s*999\s*\n[^\n]*\n)*\s*0\s*\n\s*SECTION\s*\n", re.IGNORECASE)
_HEADER = 200_000  # characters in which the header's variables are looked for
_BINARY = b"AutoCAD Binary DXF"
_UNITS = re.compile(r"\n\s*9\s*\n\s*\$INSUNITS\s*\n\s*70\s*\n\s*(\d{1,2})\s*\n")
_UNIT_NAMES = {1: "in", 2: "ft", 3: "mi", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 21: "us-ft"}
_LARGEST = 1 << 62  # more vertices than any file has
_CLOSED_M, _POLYGON_MESH, _CLOSED_N, _POLYFACE = 1, 16, 32, 64


def begins_as_dxf(head: bytes) -> bool:
    """Whether a file that begins so is one."""
    return head.startswith(_BINARY) or bool(
        _BEGINNING.match(head.replace(b"\r", b"\n").replace(b"\n\n", b"\n"))
    )


def read_dxf(file: str | Path, step: Step = no_step, rows: MakeRows = Rows) -> TriangleMesh:
    """The faces of all entities of the drawing as one mesh; corners at the same place become one vertex.
    Faces in blocks that are inserted are not read. rows: where they are kept. Raises InputRefused naming file
    and line."""
    file = Path(file)
    with file.open("rb") as opened:
        if opened.read(len(_BINARY)) == _BINARY:
            raise InputRefused("binary DXF is not read", file=file, advice="save it as text (ASCII)")
    corners, sizes, lines = rows(np.empty((0, 3))), rows(np.empty(0, np.int64)), _Lines(file, step)
    count = sum(_keep(some, corners, sizes) for some in _faces(file, lines, rows))
    if not count:
        advice = "export the surface as 3D faces (3DFACE) or as a polyface mesh"
        raise InputRefused("it has no 3D faces", file=file, advice=advice)
    mesh = MeshRows(file, rows)
    share_vertices(corners.array(), sizes.array(), mesh, rows)
    # many programs write the unit of their template, so that nothing is converted by it
    said = _UNITS.search(lines.head)
    unit = _UNIT_NAMES.get(int(said[1])) if said else None
    return replace(mesh.mesh(), said_unit=unit)


def _faces(file: Path, lines: _Lines, rows: MakeRows) -> Iterator[list[list[tuple[float, ...]]]]:
    """The places of the corners of faces, some faces at a time."""
    faces = []
    for entity, number, codes in _entities(file, lines, rows):
        try:
            if entity == "3DFACE":
                given = [_place(codes, corner) for corner in range(4 if 13 in codes else 3)]
                faces.append(_without_repeats(given))
            elif entity == "POLYLINE":
                for some in codes["mesh"].faces():
                    faces += some
                    if len(faces) >= LINES_AT_ONCE:
                        yield faces
                        faces = []
        except (ValueError, KeyError, IndexError) as error:
            raise InputRefused(f"a {entity} that cannot be read", file=file, line=number) from error
        if len(faces) >= LINES_AT_ONCE:
            yield faces
            faces = []
    yield faces


def _keep(faces: list[list[tuple[float, ...]]], corners: Rows, sizes: Rows) -> int:
    """Adds faces that are some; how many there were."""
    faces = [face for face in faces if len(face) > 2]
    if faces:
        corners.add(np.array([place for face in faces for place in face]) + 0.0)  # zero has one sign
        sizes.add(np.array([len(face) for face in faces]))
    return len(faces)


class _Lines:
    """The lines of a file by twos, as a DXF has them. head: what it begins with, once some were read; count:
    of lines, once all were."""

    def __init__(self, file: Path, step: Step):
        self._file, self._step = file, step
        self.head, self.count = "", 0

    def pairs(self) -> Iterator[tuple[int, str, str]]:
        """The number of the first, from 1, and both."""
        rest: list[str] = []
        for first, lines, share in text_lines(self._file):
            if first == 1:
                self.head = "\n".join(lines)[:_HEADER]
            self.count = first + len(lines) - 1
            number = first - len(rest)
            lines = rest + lines
            for at in range(0, len(lines) - 1, 2):
                yield number + at, lines[at].strip(), lines[at + 1].strip()
            rest = lines[len(lines) // 2 * 2 :]
            self._step(0.5 * share)


def _entities(file: Path, lines: _Lines, rows: MakeRows) -> Iterator[tuple[str, int, dict]]:
    """Each entity of the section ENTITIES: its name, line, and values by group code. A POLYLINE has its
    VERTEX entities under "mesh"."""
    within, section, polyline = False, False, None
    name, begin = "", 0
    codes: dict = {}
    for at, code, value in lines.pairs():
        if not code.lstrip("-").isdecimal():
            raise InputRefused(f"'{code:.40}' is no group code", file=file, line=at)
        if code != "0":
            if section and code == "2":
                within, section = value.upper() == "ENTITIES", False
            if within:
                codes.setdefault(int(code[:9]), value)
            continue
        if within and name:
            if name == "VERTEX" and polyline is not None:
                polyline[2]["mesh"].add(codes)
            elif name == "POLYLINE":
                polyline = (name, begin, {"mesh": _Polyline(codes, rows)})
            elif name == "SEQEND" and polyline is not None:
                yield polyline
                polyline = None
            else:
                yield name, begin, codes
        name, begin, codes = value.upper(), at + 1, {}
        section = name == "SECTION"
        within = within and name != "ENDSEC"
        if name == "EOF":
            return
    raise InputRefused("the file has no EOF", file=file, line=lines.count, advice="it is cut off")


def _place(codes: dict, corner: int) -> tuple[float, ...]:
    return tuple(float(codes.get(10 * axis + corner, "0")) for axis in (1, 2, 3))


def _without_repeats(corners: list) -> list:
    return [corner for k, corner in enumerate(corners) if corner != corners[k - 1]]


class _Polyline:
    """A POLYLINE, whose vertices come one by one. What is wrong in them is an error once the faces are
    wanted: without an end there are none."""

    def __init__(self, codes: dict, rows: MakeRows):
        self._codes, self._rows = codes, rows
        self._waiting: list[dict] = []
        self._kept: tuple[Rows, Rows] | None = None  # where there are many
        self._error: ValueError | None = None

    def add(self, vertex: dict) -> None:
        self._waiting.append(vertex)
        if len(self._waiting) >= LINES_AT_ONCE:
            self._kept = self._kept or _no_rows(self._rows)
            self._move(*self._kept)

    def _move(self, places: Rows, numbers: Rows) -> None:
        """Moves the vertices that wait: places, and numbers of those of a face, from 1, 0 for none."""
        vertices, self._waiting = self._waiting, []
        try:
            flags = int(self._codes.get(70, "0"))
            if flags & _POLYFACE:
                found = [_place(v, 0) for v in vertices if int(v.get(70, "0")) & 64]
                faces = [v for v in vertices if int(v.get(70, "0")) & 192 == 128]
                numbers.add(np.array([[_number(v, code) for code in (71, 72, 73, 74)] for v in faces]))
            elif flags & _POLYGON_MESH:
                found = [_place(v, 0) for v in vertices if not int(v.get(70, "0")) & 16]
            else:
                found = []
            places.add(np.array(found))
        except ValueError as error:
            self._error = self._error or error

    def faces(self) -> Iterator[list[list[list[float]]]]:
        """The places of the corners of faces, some faces at a time. Raises ValueError, KeyError and
        IndexError."""
        kept = self._kept or _no_rows(Rows)
        self._move(*kept)
        if self._error:
            raise self._error
        places, numbers = (rows.array() for rows in kept)
        flags = int(self._codes.get(70, "0"))
        if flags & _POLYFACE:
            for begin in range(0, len(numbers), LINES_AT_ONCE):
                some = numbers[begin : begin + LINES_AT_ONCE]
                used = np.unique(some[some > 0])
                place = dict(zip(used.tolist(), places[used - 1].tolist(), strict=True))
                yield [_without_repeats([place[n] for n in face if n]) for face in some.tolist()]
        elif flags & _POLYGON_MESH:
            rows, columns = int(self._codes[71]), int(self._codes[72])
            if rows * columns != len(places):
                raise ValueError
            for m in range(rows if flags & _CLOSED_M else rows - 1):
                two = [places[r * columns : (r + 1) * columns].tolist() for r in (m, (m + 1) % rows)]
                ends = [(n, (n + 1) % columns) for n in range(columns if flags & _CLOSED_N else columns - 1)]
                around = [[two[0][n], two[1][n], two[1][k], two[0][k]] for n, k in ends]
                yield [_without_repeats(face) for face in around]


def _no_rows(rows: MakeRows) -> tuple[Rows, Rows]:
    return rows(np.empty((0, 3))), rows(np.empty((0, 4), np.int64))


def _number(vertex: dict, code: int) -> int:
    return min(abs(int(vertex.get(code, "0"))), _LARGEST)
