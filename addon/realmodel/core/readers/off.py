# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in the Object File Format (Geomview's OFF), as text."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..errors import InputRefused
from .text import LINES_AT_ONCE, NOT_FINITE, NUMBER, Step, column_numbers, no_step, read_text
from .triangle_mesh import TriangleMesh

_WHOLE = re.compile(r"-?[0-9]{1,18}")
_HEADERS = ("OFF", "COFF", "NOFF", "CNOFF")  # colours and normals behind the coordinates are not used


def begins_as_off(head: bytes) -> bool:
    """Whether a file that begins with these bytes is one, comments apart."""
    lines = (line.partition(b"#")[0].split() for line in head.removeprefix(b"\xef\xbb\xbf").splitlines())
    words = next((words for words in lines if words), [b""])
    return words[0].upper().decode("latin-1") in _HEADERS


def read_off(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads an OFF mesh. Raises InputRefused naming file and line.

    step(fraction) is called at least every 20,000 lines; what it raises passes through.
    """
    file = Path(file)
    lines, numbers = _numbered_lines(read_text(file), step)
    start, vertex_count, face_count = _counts(file, lines, numbers)
    body, numbers = lines[start:], numbers[start:]
    if len(body) < vertex_count + face_count:
        part = "vertices" if len(body) < vertex_count else "faces"
        found = len(body) if part == "vertices" else len(body) - vertex_count
        announced = vertex_count if part == "vertices" else face_count
        last = numbers[-1] if len(numbers) else None
        raise InputRefused(
            f"{announced} {part} are announced, there are {found}",
            file=file,
            line=last,
            advice="the file is cut off or its counts are wrong",
        )
    if len(body) > vertex_count + face_count:
        raise InputRefused(
            f"there is more than the {vertex_count} vertices and {face_count} faces announced",
            file=file,
            line=numbers[vertex_count + face_count],
            advice="correct the counts",
        )
    vertices = _vertices(file, body[:vertex_count], numbers, lambda f: step(0.4 * f))
    faces, lines_of_faces = body[vertex_count:], numbers[vertex_count:]
    return _faces(file, vertices, faces, lines_of_faces, lambda f: step(0.4 + 0.6 * f))


def _numbered_lines(text: str, step: Step) -> tuple[list[str], list[int]]:
    """The lines that say something, without comments, and their numbers from 1."""
    lines, numbers = [], []
    for number, line in enumerate(text.split("\n"), 1):
        if number % LINES_AT_ONCE == 0:
            step(0.0)
        line = line.partition("#")[0].strip() if "#" in line else line.strip()
        if line:
            lines.append(line)
            numbers.append(number)
    return lines, numbers


def _counts(file: Path, lines: list[str], numbers: list[int]) -> tuple[int, int, int]:
    """Where the vertices begin, how many there are, and how many faces."""
    if not lines:
        raise InputRefused("the file is empty", file=file)
    head = lines[0].split()
    if head[0].upper() not in _HEADERS:
        raise InputRefused(
            f"the file does not begin with OFF but with '{head[0][:20]}'", file=file, line=numbers[0]
        )
    if "BINARY" in head:
        raise InputRefused("binary OFF is not read", file=file, line=numbers[0], advice="save it as text")
    start = 1
    entries = head[1:]
    if not entries:
        if len(lines) < 2:
            raise InputRefused("the counts of vertices and faces are missing", file=file, line=numbers[0])
        start, entries = 2, lines[1].split()
    if len(entries) < 2 or not all(_WHOLE.fullmatch(entry) for entry in entries[:2]):
        raise InputRefused(
            "this line must give the numbers of vertices and faces",
            file=file,
            line=numbers[start - 1],
            advice="write: VERTICES FACES 0",
        )
    if min(int(entries[0]), int(entries[1])) <= 0:
        raise InputRefused("the mesh has no vertices or no faces", file=file, line=numbers[start - 1])
    return start, int(entries[0]), int(entries[1])


def _vertices(file: Path, lines: list[str], numbers: list[int], step: Step) -> np.ndarray:
    try:
        vertices = column_numbers(lines, (0, 1, 2), None, np.float64, step)
        if np.isfinite(vertices).all():
            return vertices
    except ValueError:
        pass
    for line, number in zip(lines, numbers, strict=False):
        entries = line.split()[:3]
        if len(entries) < 3:
            raise InputRefused(
                f"a vertex needs 3 coordinates, there are {len(entries)}", file=file, line=number
            )
        for entry in entries:
            if NOT_FINITE.fullmatch(entry):
                raise InputRefused(f"a coordinate is {entry}, not a finite number", file=file, line=number)
            if not NUMBER.fullmatch(entry) or not np.isfinite(float(entry)):
                raise InputRefused(f"a coordinate is not a number: '{entry}'", file=file, line=number)
    raise InputRefused("the vertices cannot be read", file=file, line=numbers[0])


def _faces(
    file: Path, vertices: np.ndarray, lines: list[str], numbers: list[int], step: Step
) -> TriangleMesh:
    try:
        table = column_numbers(lines, (0, 1, 2, 3), None, np.int64, step)
    except ValueError:
        table = None
    if table is not None and len(table) == len(lines) and (table[:, 0] == 3).all():
        bad = np.flatnonzero(((table[:, 1:] < 0) | (table[:, 1:] >= len(vertices))).any(axis=1))
        if len(bad):
            raise _no_vertex(file, numbers[bad[0]], table[bad[0], 1:], len(vertices))
        return TriangleMesh(vertices, np.ascontiguousarray(table[:, 1:], np.int32))
    triangles, owner = [], []
    for face, (line, number) in enumerate(zip(lines, numbers, strict=True)):
        if face % LINES_AT_ONCE == 0:
            step(face / len(lines))
        corners = _polygon(file, line, number, len(vertices))
        triangles += [(corners[0], b, c) for b, c in pairwise(corners[1:])]
        owner += [face] * (len(corners) - 2)
    return TriangleMesh(vertices, np.array(triangles, np.int32), np.array(owner, np.int64))


def _polygon(file: Path, line: str, number: int, vertex_count: int) -> list[int]:
    entries = line.split()
    if not _WHOLE.fullmatch(entries[0]):
        raise InputRefused(
            f"a face must begin with its number of corners, not '{entries[0]}'", file=file, line=number
        )
    size = int(entries[0])
    if size < 3:
        raise InputRefused(f"a face needs at least 3 corners, not {size}", file=file, line=number)
    if len(entries) <= size:
        raise InputRefused(f"a face of {size} corners names only {len(entries) - 1}", file=file, line=number)
    if not all(_WHOLE.fullmatch(entry) for entry in entries[1 : size + 1]):
        raise InputRefused("the corners of a face must be vertex numbers", file=file, line=number)
    corners = [int(entry) for entry in entries[1 : size + 1]]
    if min(corners) < 0 or max(corners) >= vertex_count:
        raise _no_vertex(file, number, corners, vertex_count)
    return corners


def _no_vertex(file: Path, line: int, corners, vertex_count: int) -> InputRefused:
    corner = next(c for c in corners if not 0 <= c < vertex_count)
    return InputRefused(
        f"there is no vertex {corner}",
        file=file,
        line=line,
        advice=f"they are numbered from 0 to {vertex_count - 1}",
    )
