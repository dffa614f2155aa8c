# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in the Object File Format (Geomview's OFF), as text."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ..errors import InputRefused
from .text import LINES_AT_ONCE, NUMBER, Step, column_numbers, no_step, read_text
from .triangle_mesh import TriangleMesh, mesh_of_faces

_WHOLE = re.compile(r"-?[0-9]{1,18}")
_HEADERS = ("OFF", "COFF", "NOFF", "CNOFF")  # colors and normals behind the coordinates are not used


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
    lines_of_faces = numbers[vertex_count:]
    faces = _faces(body[vertex_count:], lines_of_faces, file, lambda f: step(0.4 + 0.6 * f))
    return mesh_of_faces(file, vertices, faces, lines_of_faces)


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
        are_numbers = all(NUMBER.fullmatch(entry) and np.isfinite(float(entry)) for entry in entries)
        if len(entries) < 3 or not are_numbers:
            what = f"a vertex needs 3 finite coordinates, there is '{' '.join(entries):.40}'"
            raise InputRefused(what, file=file, line=number)
    raise InputRefused("the vertices cannot be read", file=file, line=numbers[0])


def _faces(lines: list[str], numbers: list[int], file: Path, step: Step) -> np.ndarray | list[list[int]]:
    """The corners of each face."""
    try:
        table = column_numbers(lines, (0, 1, 2, 3), None, np.int64, step)
        if len(table) == len(lines) and (table[:, 0] == 3).all():
            return table[:, 1:]
    except ValueError:
        pass
    faces = []
    for face, (line, number) in enumerate(zip(lines, numbers, strict=True)):
        if face % LINES_AT_ONCE == 0:
            step(face / len(lines))
        entries = line.split()
        size = int(entries[0]) if _WHOLE.fullmatch(entries[0]) else 0
        corners = entries[1 : size + 1]
        if size < 3 or len(corners) < size or not all(map(_WHOLE.fullmatch, corners)):
            what = f"a face is its number of corners, at least 3, and their vertex numbers, not '{line:.40}'"
            raise InputRefused(what, file=file, line=number)
        faces.append([int(entry) for entry in corners])
    return faces
