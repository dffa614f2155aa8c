# SPDX-License-Identifier: GPL-3.0-or-later
"""FLAC3D grids (.f3grid), text: zones, a zone group for each block, faces and a face group for each patch and
inner surface (Itasca, FLAC3D manual, "Grid format")."""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from ...simulation import VolumeMesh
from ...simulation.elements import ElementFaces
from ..encodings.text_rows import write_rows, write_wrapped
from ..shapes.shape_parts import distinct_names

# What kinds are called there, and the order of their corners.
_ZONES = {
    "tetrahedron": ("T4", [0, 1, 2, 3]),
    "pyramid": ("P5", [0, 1, 3, 4, 2]),
    "prism": ("W6", [0, 1, 3, 2, 4, 5]),
    "hexahedron": ("B8", [0, 1, 3, 4, 2, 7, 5, 6]),
}
_FACES = {"triangle": "T3", "quadrilateral": "Q4"}
_A_LINE = 15


def write_f3grid(mesh: VolumeMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes zones and faces with their groups."""
    file.write(b"* FLAC3D grid, RealModel\n* GRIDPOINTS\n")
    write_rows(file, "G %d %r %r %r", np.arange(1, len(mesh.points) + 1), mesh.points)
    step(0.3)
    file.write(b"* ZONES\n")
    first = 1
    for kind, elements in mesh.elements.items():
        name, order = _ZONES[kind]
        numbers = np.arange(first, first + len(elements))
        write_rows(file, f"Z {name} %d" + " %d" * len(order), numbers, elements[:, order] + 1)
        first += len(elements)
    file.write(b"* ZONE GROUPS\n")
    block = mesh.of_all(mesh.element_block)
    names = distinct_names(mesh.block_names)
    for number in np.unique(block).tolist():
        _group(file, "ZGROUP", names[number], np.flatnonzero(block == number) + 1)
    step(0.6)
    sets = ElementFaces(mesh).sets()
    file.write(b"* FACES\n")
    first, groups = 1, []
    for face_set in sets:
        begin = first
        for shape, corners in face_set.corners.items():
            numbers = np.arange(first, first + len(corners))
            write_rows(file, f"F {_FACES[shape]} %d" + " %d" * corners.shape[1], numbers, corners + 1)
            first += len(corners)
        groups.append(np.arange(begin, first))
    file.write(b"* FACE GROUPS\n")
    for face_set, numbers in zip(sets, groups, strict=True):
        _group(file, "FGROUP", face_set.name, numbers)
    step(1.0)


def _group(file: BinaryIO, keyword: str, name: str, numbers: np.ndarray) -> None:
    quoted = name.replace('"', "'")
    file.write(f'{keyword} "{quoted}" SLOT 1\n'.encode())
    write_wrapped(file, " %d", numbers, _A_LINE)
