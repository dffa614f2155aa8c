# SPDX-License-Identifier: GPL-3.0-or-later
"""Abaqus and CalculiX input (.inp), text: elements by block, surfaces and node sets of the patches.

CalculiX has no pyramids: each is written as two tetrahedra, with the diagonal from the lower number of its
base.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from ...simulation import VolumeMesh
from ...simulation.elements import ElementFaces, joint_sets
from ...simulation.patches import solver_names
from ..encodings.text_rows import write_rows

_TYPES = {"tetrahedron": "C3D4", "prism": "C3D6", "hexahedron": "C3D8"}


def write_inp(mesh: VolumeMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes elements and sets: the elements of a block are the set with its name, the faces of a patch or
    inner surface a surface with its name, their nodes, and those of a group of patches, the set
    NAME_nodes."""
    file.write(b"*HEADING\nRealModel\n*NODE, NSET=all_nodes\n")
    write_rows(file, "%d, %r, %r, %r", np.arange(1, len(mesh.points) + 1), _in_field(mesh.points))
    step(0.3)
    names = solver_names(mesh.block_names)
    written, pyramids = 1, None
    numbers = []  # of each element the one that it is written with; of pyramids the first of two
    for kind, elements in mesh.elements.items():
        rows, of, label = elements, mesh.element_block[kind], kind
        if kind == "pyramid":
            pyramids = _Halves(elements)
            rows, of, label = pyramids.tetrahedra, np.repeat(of, 2), "tetrahedron"
        for block in np.unique(of).tolist():
            of_block = np.flatnonzero(of == block)
            file.write(f"*ELEMENT, TYPE={_TYPES[label]}, ELSET={names[block]}\n".encode())
            write_rows(file, "%d" + ", %d" * rows.shape[1], written + of_block, rows[of_block] + 1)
        numbers.append(written + np.arange(len(elements)) * (len(rows) // max(len(elements), 1)))
        written += len(rows)
    file.write(b"*ELSET, ELSET=all_elements, GENERATE\n1, %d, 1\n" % (written - 1))
    step(0.7)
    number = np.concatenate([*numbers, np.empty(0, np.int64)])
    first_pyramid = 0
    for kind, elements in mesh.elements.items():
        if kind == "pyramid":
            break
        first_pyramid += len(elements)
    taken = [*names, "all_elements", "all_nodes"]
    sets = ElementFaces(mesh).sets()
    joint = joint_sets(sets)
    set_names = solver_names([*taken, *joint])[len(taken) :]
    for parts, name in zip(joint.values(), set_names, strict=True):
        corners = [part.ravel() for face_set in parts for part in face_set.corners.values()]
        file.write(f"*NSET, NSET={name}_nodes\n".encode())
        write_rows(file, "%d,", np.unique(np.concatenate(corners)) + 1)
    for face_set, name in zip(sets, set_names, strict=False):
        file.write(f"*SURFACE, NAME={name}, TYPE=ELEMENT\n".encode())
        for shape in face_set.corners:
            element, side = face_set.element[shape], face_set.side[shape].astype(np.int64)
            rows, sides = number[element], side + 1
            if pyramids is not None:
                at = element - first_pyramid
                is_pyramid = (at >= 0) & (at < len(pyramids.begin))
                shift, halves = pyramids.sides(at[is_pyramid], side[is_pyramid])
                rows[is_pyramid] += shift
                sides[is_pyramid] = halves
                base = is_pyramid & (side == 0)  # both halves have a part of it
                rows = np.concatenate([rows, rows[base] + 1])
                sides = np.concatenate([sides, sides[base]])
            write_rows(file, "%d, S%d", rows, sides)
    step(1.0)


def _in_field(points: np.ndarray) -> np.ndarray:
    """Coordinates with 15 digits of the largest: CalculiX reads 20 characters of each, and would cut the
    exponent of what rounding leaves of a zero."""
    largest = float(np.abs(points).max(initial=0.0))
    digits = int(np.floor(np.log10(largest))) + 1 if largest > 0 else 0
    return np.round(points, 15 - digits) + 0.0  # no -0


class _Halves:
    """Pyramids as two tetrahedra each: tetrahedra (2 P, 4), those of a pyramid after one another; begin (P,):
    the corner of its base where the diagonal begins."""

    def __init__(self, pyramids: np.ndarray):
        base = pyramids[:, :4]
        self.begin = base.argmin(axis=1)
        around = (self.begin[:, None] + np.arange(4)) % 4
        a, b, c, d = np.take_along_axis(base, around, axis=1).T
        tip = pyramids[:, 4]
        halves = np.stack([np.stack([a, b, c, tip], axis=1), np.stack([a, c, d, tip], axis=1)], axis=1)
        self.tetrahedra = halves.reshape(-1, 4)

    def sides(self, pyramids: np.ndarray, side: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """For faces of pyramids (numbers in OUTWARD): the half that has them, and their number there from
        1."""
        edge = (side - 1 - self.begin[pyramids]) % 4
        half = np.where(side == 0, 0, edge // 2)
        return half, np.where(side == 0, 1, np.array([2, 3, 3, 4])[edge])
