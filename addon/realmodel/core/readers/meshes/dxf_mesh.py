# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces in DXF (text, any release): 3DFACE entities, polyface meshes and polygon meshes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from ...base.errors import InputRefused
from ...base.text import LINES_AT_ONCE, Step, no_step, read_text
from .triangle_mesh import TriangleMesh, mesh_of_corners

_BEGINNING = re.compile(rb"(?:\s*999\s*\n[^\n]*\n)*\s*0\s*\n\s*SECTION\s*\n", re.IGNORECASE)
_HEADER = 200_000  # characters in which the header's variables are looked for
_BINARY = b"AutoCAD Binary DXF"
_UNITS = re.compile(r"\n\s*9\s*\n\s*\$INSUNITS\s*\n\s*70\s*\n\s*(\d{1,2})\s*\n")
_UNIT_NAMES = {1: "in", 2: "ft", 3: "mi", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 21: "us-ft"}
_CLOSED_M, _POLYGON_MESH, _CLOSED_N, _POLYFACE = 1, 16, 32, 64


def begins_as_dxf(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return head.startswith(_BINARY) or bool(
        _BEGINNING.match(head.replace(b"\r", b"\n").replace(b"\n\n", b"\n"))
    )


def read_dxf(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """The faces of all entities of the drawing as one mesh; corners at the same place become one vertex.
    Faces in blocks that are inserted are not read. Raises InputRefused naming file and line."""
    file = Path(file)
    with file.open("rb") as opened:
        if opened.read(len(_BINARY)) == _BINARY:
            raise InputRefused("binary DXF is not read", file=file, advice="save it as text (ASCII)")
    text = read_text(file)
    corners: list[tuple[float, ...]] = []
    sizes: list[int] = []
    for entity, number, codes in _entities(file, text.split("\n"), step):
        faces = []
        try:
            if entity == "3DFACE":
                faces = [[_place(codes, corner) for corner in range(4 if 13 in codes else 3)]]
            elif entity == "POLYLINE":
                faces = _polyline_faces(codes)
        except (ValueError, KeyError, IndexError) as error:
            raise InputRefused(f"a {entity} that cannot be read", file=file, line=number) from error
        for face in map(_without_repeats, faces):
            if len(face) > 2:
                corners += face
                sizes.append(len(face))
    if not sizes:
        advice = "export the surface as 3D faces (3DFACE) or as a polyface mesh"
        raise InputRefused("it has no 3D faces", file=file, advice=advice)
    mesh = mesh_of_corners(file, corners, sizes)
    # many programs write the unit of their template, so that nothing is converted by it
    said = _UNITS.search(text, 0, _HEADER)
    unit = _UNIT_NAMES.get(int(said[1])) if said else None
    return replace(mesh, said_unit=unit)


def _entities(file: Path, lines: list[str], step: Step) -> Iterator[tuple[str, int, dict]]:
    """Each entity of the section ENTITIES: its name, line, and values by group code. A POLYLINE has those of
    its VERTEX entities under "vertices"."""
    within, section, polyline = False, False, None
    name, begin = "", 0
    codes: dict = {}
    for at in range(0, len(lines) - 1, 2):
        if at % LINES_AT_ONCE == 0:
            step(0.5 * at / len(lines))
        code, value = lines[at].strip(), lines[at + 1].strip()
        if not code.lstrip("-").isdecimal():
            raise InputRefused(f"'{code:.40}' is no group code", file=file, line=at + 1)
        if code != "0":
            if section and code == "2":
                within, section = value.upper() == "ENTITIES", False
            if within:
                codes.setdefault(int(code[:9]), value)
            continue
        if within and name:
            if name == "VERTEX" and polyline is not None:
                polyline[2]["vertices"].append(codes)
            elif name == "POLYLINE":
                polyline = (name, begin, {**codes, "vertices": []})
            elif name == "SEQEND" and polyline is not None:
                yield polyline
                polyline = None
            else:
                yield name, begin, codes
        name, begin, codes = value.upper(), at + 2, {}
        section = name == "SECTION"
        within = within and name != "ENDSEC"
        if name == "EOF":
            return
    raise InputRefused("the file has no EOF", file=file, line=len(lines), advice="it is cut off")


def _place(codes: dict, corner: int) -> tuple[float, ...]:
    return tuple(float(codes.get(10 * axis + corner, "0")) for axis in (1, 2, 3))


def _without_repeats(corners: list) -> list:
    return [corner for k, corner in enumerate(corners) if corner != corners[k - 1]]


def _polyline_faces(codes: dict) -> list[list[tuple[float, ...]]]:
    """The places of the corners of the faces of a polyface mesh or polygon mesh. Raises ValueError, KeyError
    and IndexError."""
    flags, vertices = int(codes.get(70, "0")), codes["vertices"]
    if flags & _POLYFACE:
        places = [_place(v, 0) for v in vertices if int(v.get(70, "0")) & 64]
        numbers = [  # from 1, 0 for none
            [abs(int(v.get(code, "0"))) for code in (71, 72, 73, 74)]
            for v in vertices
            if int(v.get(70, "0")) & 192 == 128
        ]
        return [[places[n - 1] for n in face if n] for face in numbers]
    if not flags & _POLYGON_MESH:
        return []
    rows, columns = int(codes[71]), int(codes[72])
    places = [_place(v, 0) for v in vertices if not int(v.get(70, "0")) & 16]
    if rows * columns != len(places):
        raise ValueError
    around = (0, 0), (1, 0), (1, 1), (0, 1)
    return [
        [places[(m + i) % rows * columns + (n + k) % columns] for i, k in around]
        for m in range(rows if flags & _CLOSED_M else rows - 1)
        for n in range(columns if flags & _CLOSED_N else columns - 1)
    ]
