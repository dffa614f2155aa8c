# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays as meshes of PyVista. The arrays are copied: a filter that changes a mesh changes no model.

All functions raise UsageError where PyVista is missing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.packages import extra
from ..base.work import native_module

if TYPE_CHECKING:
    import pyvista

POLYHEDRON = 42  # of VTK


@dataclass(frozen=True, eq=False)
class VtkCells:
    """Cells in the layout of VTK: the corners of cell k are corners[offsets[k] : offsets[k + 1]].

    types: (C,) uint8, vtkCellType. offsets: (C + 1,) int64. corners: int64.
    """

    types: np.ndarray
    offsets: np.ndarray
    corners: np.ndarray


def _pyvista() -> Any:
    return extra("pyvista", "to_pyvista()")


def _cell_array(offsets: np.ndarray, corners: np.ndarray) -> Any:
    return _pyvista().CellArray.from_arrays(np.array(offsets, np.int64), np.array(corners, np.int64))


def with_data(
    mesh: Any, cell_data: Mapping[str, np.ndarray], names: Mapping[str, Iterable[str]] | None = None
) -> Any:
    """The mesh, to which cell data are added, and lists of texts as field data."""
    for name, values in cell_data.items():
        if len(values):  # PyVista refuses columns without rows
            mesh.cell_data[name] = np.array(values)
    for name, texts in (names or {}).items():
        mesh.field_data[name] = list(texts)
    return mesh


def polygon_mesh(
    points: np.ndarray,
    offsets: np.ndarray,
    corners: np.ndarray,
    cell_data: Mapping[str, np.ndarray],
    names: Mapping[str, Iterable[str]] | None = None,
) -> pyvista.PolyData:
    """Polygons: points (V, 3), offsets (K + 1,), corners. cell_data: (K, ...) by name. names: lists of texts,
    which become field data."""
    mesh = _pyvista().PolyData(np.array(points), faces=_cell_array(offsets, corners))
    return with_data(mesh, cell_data, names)


def volume_grid(
    points: np.ndarray,
    cells: VtkCells,
    cell_data: Mapping[str, np.ndarray],
    names: Mapping[str, Iterable[str]],
) -> pyvista.UnstructuredGrid:
    """Cells that their corners say all of; arguments as of polygon_mesh."""
    grid = _grid(points)
    grid.SetCells(_types(cells.types), _cell_array(cells.offsets, cells.corners))
    return with_data(grid, cell_data, names)


def polyhedron_grid(
    points: np.ndarray,
    face_offsets: np.ndarray,
    face_vertices: np.ndarray,
    face_cells: np.ndarray,
    cell_data: Mapping[str, np.ndarray],
    names: Mapping[str, Iterable[str]],
) -> pyvista.UnstructuredGrid:
    """Polyhedra that share faces, in the layout of a model's arrays; each gets its faces counter-clockwise
    seen from outside, as VTK wants them."""
    count = len(next(iter(cell_data.values())))
    native = native_module()
    begin, sides = native.cell_sides(face_cells, count)
    stream, corners, corner_counts, lengths = native.describe_cells(face_offsets, face_vertices, begin, sides)
    stream = np.delete(stream, np.cumsum(lengths) - lengths)  # without the numbers of faces
    sizes = np.diff(face_offsets)[sides >> 1]
    stream = np.delete(stream, np.cumsum(sizes + 1) - (sizes + 1))  # and without those of corners
    grid = _grid(points)
    grid.SetPolyhedralCells(
        _types(np.full(count, POLYHEDRON, np.uint8)),
        _cell_array(_offsets(corner_counts), corners),
        _cell_array(begin, np.arange(len(sides))),
        _cell_array(_offsets(sizes), stream),
    )
    return with_data(grid, cell_data, names)


def blocks_of_meshes(meshes: Iterable[tuple[str, pyvista.DataSet]]) -> pyvista.MultiBlock:
    """Meshes with their names."""
    multi_block = _pyvista().MultiBlock()
    for name, mesh in meshes:
        multi_block.append(mesh, name)
    return multi_block


def _grid(points: np.ndarray) -> Any:
    grid = _pyvista().UnstructuredGrid()
    grid.points = np.array(points)
    return grid


def _types(types: np.ndarray) -> Any:
    return _pyvista().convert_array(types)


def _offsets(sizes: np.ndarray) -> np.ndarray:
    return np.concatenate([[0], np.cumsum(sizes)])
