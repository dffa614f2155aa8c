# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in the Object File Format (Geomview's OFF), as text."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import MakeRows, Rows
from ...base.text import LINES_AT_ONCE, NUMBER, Step, column_numbers, no_step, text_lines
from .triangle_mesh import MeshRows, TriangleMesh

_WHOLE = re.compile(r"-?[0-9]{1,18}")
_HEADERS = ("OFF", "COFF", "NOFF", "CNOFF")  # colors and normals behind the coordinates are not used


def begins_as_off(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins with these bytes is one, comments apart."""
    lines = (line.partition(b"#")[0].split() for line in head.removeprefix(b"\xef\xbb\xbf").splitlines())
    words = next((words for words in lines if words), [b""])
    return words[0].upper().decode("latin-1") in _HEADERS


def read_off(file: str | Path, step: Step = no_step, rows: MakeRows = Rows) -> TriangleMesh:
    """Reads an OFF mesh. rows: where it is kept. Raises InputRefused naming file and line.

    step(fraction) is called at least every 20,000 lines; what it raises passes through.
    """
    file = Path(file)
    text = _Lines(file, step)
    vertices, faces = _counts(file, text)
    mesh = MeshRows(file, rows)
    try:
        while mesh.vertices < vertices:
            lines, numbers = text.some(vertices - mesh.vertices)
            if not lines:
                break
            mesh.add_vertices(_vertices(file, lines, numbers))
        while mesh.faces < faces:
            lines, numbers = text.some(faces - mesh.faces)
            if not lines:
                break
            mesh.add_faces(_faces(lines, numbers, file), numbers)
    except InputRefused:
        text.require(vertices, faces)  # a wrong number of lines is the cause of other errors
        raise
    text.require(vertices, faces)
    return mesh.mesh()


class _Lines:
    """The nonempty lines, without comments. taken: how many there were since the header; last: the number of
    the last one, from 1."""

    def __init__(self, file: Path, step: Step):
        self._file, self._step = file, step
        self._pieces = text_lines(file)
        self._lines: list[tuple[int, str]] = []
        self._at = 0
        self.taken = 0
        self.last: int | None = None

    def some(self, most: int) -> tuple[list[str], list[int]]:
        """The next lines, not more than `most`, and their numbers; none at the end."""
        while self._at == len(self._lines):
            number, piece, share = next(self._pieces, (0, None, 1.0))
            if piece is None:
                return [], []
            said = ((n, line.partition("#")[0].strip()) for n, line in enumerate(piece, number))
            self._lines, self._at = [line for line in said if line[1]], 0
            self._share = share
        end = min(self._at + min(most, LINES_AT_ONCE), len(self._lines))
        numbered_lines, self._at = self._lines[self._at : end], end
        self._step(self._share)
        self.taken += len(numbered_lines)
        self.last = numbered_lines[-1][0]
        return [line for _, line in numbered_lines], [number for number, _ in numbered_lines]

    def begin(self) -> None:
        """The header ends here."""
        self.taken, self.last = 0, None

    def require(self, vertices: int, faces: int) -> None:
        """Reads on to the end. Raises InputRefused where there are fewer lines than this needs."""
        while self.taken <= vertices + faces:
            if not self.some(vertices + faces + 1 - self.taken)[0]:
                break
        if self.taken < vertices + faces:
            part, announced, count = "faces", faces, self.taken - vertices
            if count < 0:
                part, announced, count = "vertices", vertices, self.taken
            raise InputRefused(
                f"{announced} {part} are announced, there are {count}",
                file=self._file,
                line=self.last,
                advice="the file is cut off or its counts are wrong",
            )
        if self.taken > vertices + faces:
            raise InputRefused(
                f"there is more than the {vertices} vertices and {faces} faces announced",
                file=self._file,
                line=self.last,
                advice="correct the counts",
            )


def _counts(file: Path, text: _Lines) -> tuple[int, int]:
    """The numbers of vertices and faces."""
    lines, numbers = text.some(1)
    if not lines:
        raise InputRefused("the file is empty", file=file)
    head = lines[0].split()
    if head[0].upper() not in _HEADERS:
        what = f"the file does not begin with OFF but with '{head[0][:20]}'"
        raise InputRefused(what, file=file, line=numbers[0])
    if "BINARY" in head:
        raise InputRefused("binary OFF is not read", file=file, line=numbers[0], advice="save it as text")
    line, entries = numbers[0], head[1:]
    if not entries:
        lines, numbers = text.some(1)
        if not lines:
            raise InputRefused("the counts of vertices and faces are missing", file=file, line=line)
        line, entries = numbers[0], lines[0].split()
    if len(entries) < 2 or not all(_WHOLE.fullmatch(entry) for entry in entries[:2]):
        raise InputRefused(
            "this line must give the numbers of vertices and faces",
            file=file,
            line=line,
            advice="write: VERTICES FACES 0",
        )
    if min(int(entries[0]), int(entries[1])) <= 0:
        raise InputRefused("the mesh has no vertices or no faces", file=file, line=line)
    text.begin()
    return int(entries[0]), int(entries[1])


def _vertices(file: Path, lines: list[str], numbers: list[int]) -> np.ndarray:
    try:
        vertices = column_numbers(lines, (0, 1, 2), None, np.float64)
        if np.isfinite(vertices).all():
            return vertices
    except ValueError:
        pass
    for line, number in zip(lines, numbers, strict=False):
        entries = line.split()[:3]
        are_numbers = all(NUMBER.fullmatch(entry) and np.isfinite(float(entry)) for entry in entries)
        if len(entries) < 3 or not are_numbers:
            what = f"a vertex needs 3 finite coordinates, there is '{' '.join(entries):.40}'"
            raise InputRefused(what, file=file, line=number)
    raise InputRefused("the vertices cannot be read", file=file, line=numbers[0])


def _faces(lines: list[str], numbers: list[int], file: Path) -> np.ndarray | list[list[int]]:
    """The corners of each face."""
    try:
        table = column_numbers(lines, (0, 1, 2, 3), None, np.int64)
        if len(table) == len(lines) and (table[:, 0] == 3).all():
            return table[:, 1:]
    except ValueError:
        pass
    faces = []
    for line, number in zip(lines, numbers, strict=True):
        entries = line.split()
        size = int(entries[0]) if _WHOLE.fullmatch(entries[0]) else 0
        corners = entries[1 : size + 1]
        if size < 3 or len(corners) < size or not all(map(_WHOLE.fullmatch, corners)):
            what = f"a face is its number of corners, at least 3, and their vertex numbers, not '{line:.40}'"
            raise InputRefused(what, file=file, line=number)
        faces.append([int(entry) for entry in corners])
    return faces
