# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK unstructured grid (.vtu) of polyhedral cells, binary, for ParaView, PyVista and meshio.

Polyhedra stand as `faces` (for each cell: number of
faces, then for each face its number of corners and the corners) and `faceoffsets` (end of each cell).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from ..simulation import PolyhedralMesh
from ..work import native_module
from .vtk_xml import END, ArrayTag, write_array, write_header, write_length

_POLYHEDRON = 42
_CELLS_AT_ONCE = 20_000


def write_vtu(mesh: PolyhedralMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes every cell as a polyhedron, with the cell arrays `block` (number in the model's list),
    `property` (library id, 0: none) and `compartment`. Faces turn counter-clockwise seen from outside their
    cell."""
    cells = CellFaces(mesh)
    count = len(mesh.cell_block)
    streams = cells.stream_length()
    faces_size = 8 * int(streams.sum())
    tags = [  # connectivity is last: its length is found on the way
        ArrayTag("Points", "Points", "f8", mesh.points.nbytes, 3),
        ArrayTag("CellData", "block", "i4", 4 * count),
        ArrayTag("CellData", "property", "i4", 4 * count),
        ArrayTag("CellData", "compartment", "i4", 4 * count),
        ArrayTag("Cells", "types", "u1", count),
        ArrayTag("Cells", "faceoffsets", "i8", 8 * count),
        ArrayTag("Cells", "faces", "i8", faces_size),
        ArrayTag("Cells", "offsets", "i8", 8 * count),
        ArrayTag("Cells", "connectivity", "i8", 0),
    ]
    write_header(file, len(mesh.points), count, tags)
    write_array(file, np.ascontiguousarray(mesh.points, "<f8"))
    write_array(file, mesh.cell_block.astype("<i4"))
    write_array(file, mesh.block_property[mesh.cell_block].astype("<i4") if count else np.empty(0, "<i4"))
    write_array(file, np.ascontiguousarray(mesh.cell_compartment, "<i4"))
    write_array(file, np.full(count, _POLYHEDRON, np.uint8))
    write_array(file, np.cumsum(streams).astype("<i8"))
    faces_at = file.tell()
    offsets_at = faces_at + 8 + faces_size
    corners_at = offsets_at + 8 + 8 * count
    write_length(file, faces_size)
    faces_at, next_corners_at = faces_at + 8, corners_at + 8
    corners = np.zeros(count, np.int64)
    for start in range(0, count, _CELLS_AT_ONCE):
        end = min(count, start + _CELLS_AT_ONCE)
        stream, vertices, corners[start:end] = cells.described(start, end)
        file.seek(faces_at)
        file.write(stream.astype("<i8", copy=False))
        file.seek(next_corners_at)
        file.write(vertices.astype("<i8", copy=False))
        faces_at, next_corners_at = faces_at + stream.nbytes, next_corners_at + vertices.nbytes
        step(end / count)
    file.seek(offsets_at)
    write_array(file, np.cumsum(corners).astype("<i8"))
    write_length(file, 8 * int(corners.sum()))
    file.seek(next_corners_at)
    file.write(END)
    step(1.0)


class CellFaces:
    """The faces of each cell, from the two cells of each face."""

    def __init__(self, mesh: PolyhedralMesh):
        self.mesh = mesh
        self.face_size = np.diff(mesh.face_offsets)
        self.begin, sides = native_module().cell_sides(mesh.face_cells, len(mesh.cell_block))
        self.face, self.turned = sides >> 1, (sides & 1).astype(bool)

    def stream_length(self) -> np.ndarray:
        """(C,) how many numbers describe the faces of each cell."""
        ends = np.concatenate([[0], np.cumsum(self.face_size[self.face] + 1)])
        return ends[self.begin[1:]] - ends[self.begin[:-1]] + 1

    def _sides(self, start: int, end: int):
        """Of the cells start..end: their sides' cells (from 0), sizes, and corners side after side."""
        side = slice(self.begin[start], self.begin[end])
        face = self.face[side]
        size = self.face_size[face]
        cell = np.repeat(np.arange(end - start), np.diff(self.begin[start : end + 1]))
        owner = np.repeat(np.arange(len(face)), size)
        rank = np.arange(len(owner)) - np.repeat(np.cumsum(size) - size, size)
        rank = np.where(self.turned[side][owner], size[owner] - 1 - rank, rank)
        corners = self.mesh.face_vertices[self.mesh.face_offsets[face][owner] + rank]
        return cell, size, owner, corners

    def described(self, start: int, end: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the cells start..end: int64 for each its number of faces, and each face's number of corners and
        corners; the vertices of each, every one once and in order; and how many these are (a cell)."""
        cell, size, owner, corners = self._sides(start, end)
        width = len(self.mesh.points)
        key = np.sort(cell[owner].astype(np.int64) * width + corners)
        key = key[np.append(True, key[1:] != key[:-1])] if len(key) else key
        return (
            self._stream(start, end, cell, size, owner, corners),
            key % width,
            np.bincount(key // width, minlength=end - start),
        )

    def _stream(self, start: int, end: int, cell, size, owner, corners) -> np.ndarray:
        faces = np.diff(self.begin[start : end + 1])
        stream = np.empty(len(corners) + len(size) + len(faces), np.int64)
        # every side is preceded by all corners and sizes before it, and by the counts of cells up to its own
        at_side = np.cumsum(size) - size + np.arange(len(size)) + cell + 1
        first = self.begin[start:end] - self.begin[start]
        stream[at_side[first] - 1] = faces
        stream[at_side] = size
        stream[np.arange(len(corners)) + owner + cell[owner] + 2] = corners
        return stream
