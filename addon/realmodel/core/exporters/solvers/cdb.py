# SPDX-License-Identifier: GPL-3.0-or-later
"""ANSYS MAPDL input (.cdb), text: blocked nodes and elements of type SOLID185, components for blocks and
patches
(ANSYS, Programmer's Reference, "Format of the coded database file")."""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from ...simulation import VolumeMesh
from ...simulation.elements import ElementFaces, joint_sets
from ...simulation.patches import solver_names
from ..encodings.text_rows import write_rows, write_wrapped

# Of a brick with repeated corners.
_AS_BRICK = {
    "tetrahedron": [0, 1, 2, 2, 3, 3, 3, 3],
    "pyramid": [0, 1, 2, 3, 4, 4, 4, 4],
    "prism": [0, 1, 2, 2, 3, 4, 5, 5],
    "hexahedron": [0, 1, 2, 3, 4, 5, 6, 7],
}
_LONGEST_NAME = 32


def write_cdb(mesh: VolumeMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes elements; the material of each is the number of its block from 1. The component of a block holds
    elements, that of a patch, a group of patches or an inner surface nodes."""
    points, cells = len(mesh.points), mesh.cells
    file.write(
        f"/COM,RealModel\n/PREP7\nET,1,185\nNBLOCK,6,SOLID,{points:9d},{points:9d}\n(3i9,6e25.16e3)\n".encode()
    )
    form = "%9d        0        0%25.16E%25.16E%25.16E"
    write_rows(file, form, np.arange(1, points + 1), mesh.points)
    file.write(b"N,R5.3,LOC,       -1,\n")
    step(0.3)
    file.write(f"EBLOCK,19,SOLID,{cells:9d},{cells:9d}\n(19i9)\n".encode())
    form = "%9d        1        1        1        0        0        0        0        8        0" + "%9d" * 9
    first = 1
    for kind, elements in mesh.elements.items():
        numbers = np.arange(first, first + len(elements))
        write_rows(file, form, mesh.element_block[kind] + 1, numbers, elements[:, _AS_BRICK[kind]] + 1)
        first += len(elements)
    file.write(b"       -1\n")
    step(0.7)
    sets = joint_sets(ElementFaces(mesh).sets())
    block = mesh.of_all(mesh.element_block)
    present = np.unique(block).tolist()
    names = solver_names([*(mesh.block_names[k] for k in present), *sets], longest=_LONGEST_NAME)
    for number, name in zip(present, names, strict=False):
        _component(file, name, "ELEM", np.flatnonzero(block == number) + 1)
    for face_sets, name in zip(sets.values(), names[len(present) :], strict=True):
        corners = [part.ravel() for face_set in face_sets for part in face_set.corners.values()]
        _component(file, name, "NODE", np.unique(np.concatenate(corners)) + 1)
    file.write(b"FINISH\n")
    step(1.0)


def _component(file: BinaryIO, name: str, kind: str, numbers: np.ndarray) -> None:
    """Numbers in ascending order; the last of a range of several stands there as -last."""
    begins = np.append(True, np.diff(numbers) != 1)
    first = numbers[begins]
    last = numbers[np.append(begins[1:], True)]
    items = np.column_stack([first, -last])
    items = items.ravel()[np.column_stack([np.ones(len(first), bool), last > first]).ravel()]
    file.write(f"CMBLOCK,{name.upper():8s},{kind},{len(items):8d}\n(8i10)\n".encode())
    write_wrapped(file, "%10d", items, 8)
