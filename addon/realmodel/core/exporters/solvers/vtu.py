# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK unstructured grid (.vtu), binary, of polyhedral cells or of elements, for ParaView, PyVista, meshio
and OpenGeoSys.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from ...base.work import native_module, on_threads
from ...simulation import PolyhedralMesh, VolumeMesh
from ..encodings.vtk_xml import END, ArrayTag, write_array, write_grid, write_header, write_length

_POLYHEDRON = 42
_CELLS_AT_ONCE = 2_000  # the memory for more of them would be asked for anew each time
_LARGEST_INT32 = 2**31 - 1


def write_vtu(mesh: PolyhedralMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes every cell as a polyhedron, with the cell arrays `block` (number in the model's list),
    `property` (library id, 0: none), `compartment` and `volume`, as VTK computes only those of convex cells.
    Faces turn counter-clockwise seen from outside their
    cell. Numbers of points and of numbers are Int32 where they fit, which halves the file, else Int64."""
    cells = CellFaces(mesh)
    count = len(mesh.cell_block)
    numbers = count + cells.description_length()  # no array is longer
    kind = "i4" if max(numbers, len(mesh.points)) <= _LARGEST_INT32 else "i8"
    dtype = np.dtype(f"<{kind}")
    faces_size, each_size = dtype.itemsize * numbers, dtype.itemsize * count
    tags = [  # connectivity is last: its length is found on the way
        ArrayTag("Points", "Points", "f8", mesh.points.nbytes, 3),
        ArrayTag("CellData", "block", "i4", 4 * count),
        ArrayTag("CellData", "property", "i4", 4 * count),
        ArrayTag("CellData", "compartment", "i4", 4 * count),
        ArrayTag("CellData", "volume", "f8", 8 * count),
        ArrayTag("Cells", "types", "u1", count),
        ArrayTag("Cells", "faceoffsets", kind, each_size),
        ArrayTag("Cells", "faces", kind, faces_size),
        ArrayTag("Cells", "offsets", kind, each_size),
        ArrayTag("Cells", "connectivity", kind, 0),
    ]
    write_header(file, len(mesh.points), count, tags)
    write_array(file, np.ascontiguousarray(mesh.points, "<f8"))
    write_array(file, mesh.cell_block.astype("<i4"))
    write_array(file, mesh.block_property[mesh.cell_block].astype("<i4") if count else np.empty(0, "<i4"))
    write_array(file, np.ascontiguousarray(mesh.cell_compartment, "<i4"))
    volumes = native_module().cell_volumes
    write_array(
        file,
        volumes(
            mesh.points, mesh.face_offsets, mesh.face_vertices, mesh.face_cells, count, on_threads(0)
        ).astype("<f8", copy=False),
    )
    write_array(file, np.full(count, _POLYHEDRON, np.uint8))
    ends_at = file.tell()
    faces_at = ends_at + 8 + each_size
    offsets_at = faces_at + 8 + faces_size
    corners_at = offsets_at + 8 + each_size
    file.seek(faces_at)
    write_length(file, faces_size)
    faces_at, next_corners_at = faces_at + 8, corners_at + 8
    corners, lengths = np.zeros((2, count), np.int64)
    for start in range(0, count, _CELLS_AT_ONCE):
        end = min(count, start + _CELLS_AT_ONCE)
        stream, vertices, corners[start:end], lengths[start:end] = cells.described(start, end)
        stream, vertices = (array.astype(dtype, copy=False) for array in (stream, vertices))
        file.seek(faces_at)
        file.write(stream)
        file.seek(next_corners_at)
        file.write(vertices)
        faces_at, next_corners_at = faces_at + stream.nbytes, next_corners_at + vertices.nbytes
        step(end / count)
    file.seek(ends_at)
    write_array(file, np.cumsum(lengths).astype(dtype))
    file.seek(offsets_at)
    write_array(file, np.cumsum(corners).astype(dtype))
    write_length(file, dtype.itemsize * int(corners.sum()))
    file.seek(next_corners_at)
    file.write(END)
    step(1.0)


class CellFaces:
    """The faces of each cell, from the two cells of each face.

    begin: (C + 1,) uint32, where the faces of each cell begin."""

    def __init__(self, mesh: PolyhedralMesh):
        self.mesh = mesh
        self.begin, self._sides = native_module().cell_sides(mesh.face_cells, len(mesh.cell_block))

    @property
    def face(self) -> np.ndarray:
        """(N,) uint32: the faces of all cells, cell by cell."""
        return self._sides >> 1

    @property
    def turned(self) -> np.ndarray:
        """(N,) bool: whether the cell is the second one of its face."""
        return (self._sides & 1).astype(bool)

    def description_length(self) -> int:
        """The number of integers that describe the faces of all cells: for each face the number of its
        corners, and the corners."""
        cells = self.mesh.face_cells
        size = np.diff(self.mesh.face_offsets) + 1
        return int(size[cells[:, 0] >= 0].sum() + size[cells[:, 1] >= 0].sum())

    def described(self, start: int, end: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """The description of the cells start..end, int64: for each cell its number of faces, and for each
        face its number of corners and its corners; the vertices of each cell, each once and in order; the
        number of these for each cell; and for each cell the number of integers in the first array."""
        return native_module().describe_cells(
            self.mesh.face_offsets, self.mesh.face_vertices, self.begin[start : end + 1], self._sides
        )


def write_vtu_elements(mesh: VolumeMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes elements with the cell arrays `MaterialIDs`, as OpenGeoSys calls it, and `block`, both the
    number of the block in the model's list, `property` (library id, 0: none) and, where it is known,
    `compartment`."""
    cells, data = mesh.vtk_cells(), mesh.cell_data()
    step(0.3)
    write_grid(
        file,
        [
            ("Points", "Points", mesh.points.astype("<f8", copy=False)),
            ("Cells", "connectivity", cells.corners.astype("<i8")),
            ("Cells", "offsets", cells.offsets[1:].astype("<i8")),
            ("Cells", "types", cells.types),
            *(
                ("CellData", name, values.astype("<i4"))
                for name, values in {"MaterialIDs": data["block"], **data}.items()
            ),
        ],
    )
    step(1.0)
