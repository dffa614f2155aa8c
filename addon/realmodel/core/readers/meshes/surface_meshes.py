# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces as lines of text: Wavefront OBJ and GOCAD TSurf.

Coordinates are read as they stand: Z is up. What is not part of the shape (normals, colors, groups,
properties) is left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from ...base.errors import InputRefused
from ...base.text import Step, no_step, text_lines
from ...base.units import METERS
from .triangle_mesh import UNREADABLE, TriangleMesh, mesh_of_faces


def begins_as_tsurf(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is a GOCAD TSurf."""
    return head.startswith(b"GOCAD TSurf")


def begins_as_obj(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is an OBJ: comments apart, its first line is one of that format."""
    lines = (line.partition(b"#")[0].split() for line in head.removeprefix(b"\xef\xbb\xbf").splitlines())
    words = next((words for words in lines if words), [b""])
    if words[0] in (b"v", b"vt", b"vn"):
        return len(words) >= 3 and all(re.fullmatch(rb"[-+.\deE]+", word) for word in words[1:])
    return words[0] in (b"mtllib", b"usemtl", b"o", b"g") and len(words) > 1 and b"\nv " in head


def read_obj(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads all faces of a Wavefront OBJ. Raises InputRefused naming file and line."""
    file = Path(file)
    vertices: list[tuple[float, ...]] = []
    faces: list[tuple[int, ...]] = []
    lines: list[int] = []  # of the faces
    for number, words in _rows(file, step):
        try:
            if words[0] == "v":
                vertices.append(tuple(map(float, words[1:4])))
                if len(words) < 4:
                    raise ValueError
            elif words[0] == "f":
                corners = [int(word.partition("/")[0]) for word in words[1:]]
                # from 1; below zero from the last vertex so far
                faces.append(tuple([c - 1 if c > 0 else len(vertices) + c if c else -1 for c in corners]))
                lines.append(number)
        except UNREADABLE as error:
            raise _unreadable_line(file, number, words) from error
    return mesh_of_faces(file, vertices, faces, lines)


def read_tsurf(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads all surfaces of a GOCAD TSurf file as one. Depths that are positive downward become heights;
    a word says that values at vertices are not read. Raises InputRefused naming file and line."""
    file = Path(file)
    vertices: list[tuple[float, ...]] = []
    faces: list[tuple[int, ...]] = []
    lines: list[int] = []  # of the faces
    index: dict[int, int] = {}  # of the vertices of a surface, by their numbers in the file
    up = 1.0
    properties: dict[str, None] = {}
    axis_units: set[str] = set()
    for number, words in _rows(file, step):
        try:
            if words[0] == "GOCAD":
                index, up = {}, 1.0
                if words[1] != "TSurf":
                    what = f"it holds a GOCAD {words[1]:.20}, which is no triangulated surface"
                    raise InputRefused(what, file=file, line=number, advice="export the TSurf alone")
            elif words[0] == "ZPOSITIVE":
                up = -1.0 if words[1].lower() == "depth" else 1.0
            elif words[0] == "PROPERTIES":
                properties |= dict.fromkeys(words[1:])
            elif words[0] == "AXIS_UNIT":
                named = re.findall(r'"([^"]*)"', " ".join(words[1:])) or words[1:4]
                axis_units |= {word.strip().lower() for word in named}
            elif words[0] in ("VRTX", "PVRTX"):
                x, y, z = map(float, words[2:5])
                index[int(words[1])] = len(vertices)
                vertices.append((x, y, up * z))
            elif words[0] in ("ATOM", "PATOM"):
                index[int(words[1])] = index[int(words[2])]
            elif words[0] == "TRGL":
                faces.append(tuple([index[int(word)] for word in words[1:4]]))
                lines.append(number)
        except InputRefused:
            raise
        except UNREADABLE as error:
            raise _unreadable_line(file, number, words) from error
    mesh = mesh_of_faces(file, vertices, faces, lines)
    (unit,) = axis_units if len(axis_units) == 1 else (None,)
    warnings = [f"its properties {', '.join(properties)} are not read"] if properties else []
    if len(axis_units) > 1:
        warnings.append(
            f"its axes have different units ({', '.join(sorted(axis_units))}): say which in 'units'"
        )
    return replace(mesh, unit=unit if unit in METERS else None, warnings=tuple(warnings))


def _rows(file: Path, step: Step) -> Iterator[tuple[int, list[str]]]:
    """The number from 1 and the words of each line that has some, without comments."""
    for first, lines, share in text_lines(file):
        for number, line in enumerate(lines, first):
            words = line.partition("#")[0].split()
            if words:
                yield number, words
        step(share)


def _unreadable_line(file: Path, number: int, words: list[str]) -> InputRefused:
    return InputRefused(f"'{' '.join(words):.40}' cannot be read", file=file, line=number)
