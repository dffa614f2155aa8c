# SPDX-License-Identifier: GPL-3.0-or-later
"""Exodus II (Schoof and Yarberry 1994, Sandia SAND92-2137; polyhedra as blocks "nfaced", version 5), on
classic
NetCDF: an element block for each block, a side set for each patch and inner surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from ...simulation import PolyhedralMesh, VolumeMesh
from ...simulation.elements import ElementFaces
from ...simulation.patches import solver_names
from ..encodings.netcdf import NetcdfFile, characters
from .vtu import CellFaces

_TYPES = {"tetrahedron": "TET4", "pyramid": "PYRAMID5", "prism": "WEDGE6", "hexahedron": "HEX8"}
# The numbers there of the faces of OUTWARD.
_SIDES = {
    "tetrahedron": [4, 1, 2, 3],
    "pyramid": [5, 1, 2, 3, 4],
    "prism": [4, 5, 1, 2, 3],
    "hexahedron": [5, 6, 1, 2, 3, 4],
}
_NAME, _LONGEST_NAME = 33, 32


def write_exodus(mesh: VolumeMesh | PolyhedralMesh, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes a mesh of elements, or of polyhedra (without side sets, which polyhedra do not have there)."""
    netcdf = NetcdfFile()
    netcdf.attributes = {
        "api_version": np.float32(8.03),
        "version": np.float32(8.03),
        "floating_point_word_size": np.int32(8),
        "file_size": np.int32(1),
        "maximum_name_length": np.int32(_LONGEST_NAME),
        "title": "RealModel",
    }
    netcdf.dimensions = {"len_string": _NAME, "len_name": _NAME, "len_line": 81, "four": 4, "time_step": 0}
    netcdf.dimensions |= {"num_dim": 3, "num_nodes": len(mesh.points), "num_elem": mesh.cells}
    for axis, values in zip("xyz", mesh.points.T, strict=True):
        netcdf.add(f"coord{axis}", ("num_nodes",), np.ascontiguousarray(values))
    netcdf.add("coor_names", ("num_dim", "len_name"), characters(["x", "y", "z"], _NAME))
    step(0.2)
    if isinstance(mesh, PolyhedralMesh):
        _add_polyhedra(netcdf, mesh)
    else:
        _add_elements(netcdf, mesh)
    step(0.5)
    netcdf.write(file)
    step(1.0)


def _add_blocks(netcdf: NetcdfFile, names: list[str]) -> None:
    if not names:
        return
    netcdf.dimensions["num_el_blk"] = len(names)
    netcdf.add("eb_status", ("num_el_blk",), np.ones(len(names), np.int32))
    netcdf.add("eb_prop1", ("num_el_blk",), np.arange(1, len(names) + 1, dtype=np.int32), name="ID")
    netcdf.add("eb_names", ("num_el_blk", "len_name"), characters(names, _NAME))


def _add_elements(netcdf: NetcdfFile, mesh: VolumeMesh) -> None:
    words = solver_names(mesh.block_names, _LONGEST_NAME)
    names, rows = [], []
    number = np.zeros(mesh.cells, np.int64)  # of each element there, from 1
    kind_of, first, written = np.zeros(mesh.cells, np.int8), 0, 1
    for at, (kind, elements) in enumerate(mesh.elements.items()):
        of = mesh.element_block[kind]
        kind_of[first : first + len(elements)] = at
        for block in np.unique(of).tolist():
            of_block = np.flatnonzero(of == block)
            names.append(words[block])
            rows.append((kind, elements[of_block]))
            number[first + of_block] = written + np.arange(len(of_block))
            written += len(of_block)
        first += len(elements)
    _add_blocks(netcdf, solver_names(names, _LONGEST_NAME))
    for k, (kind, elements) in enumerate(rows, 1):
        sizes = (f"num_el_in_blk{k}", f"num_nod_per_el{k}")
        netcdf.dimensions |= dict(zip(sizes, elements.shape, strict=True))
        netcdf.add(f"connect{k}", sizes, (elements + 1).astype(np.int32), elem_type=_TYPES[kind])
    sets = ElementFaces(mesh).sets(_LONGEST_NAME)
    if not sets:
        return
    netcdf.dimensions["num_side_sets"] = len(sets)
    netcdf.add("ss_status", ("num_side_sets",), np.ones(len(sets), np.int32))
    netcdf.add("ss_prop1", ("num_side_sets",), np.arange(1, len(sets) + 1, dtype=np.int32), name="ID")
    netcdf.add("ss_names", ("num_side_sets", "len_name"), characters([s.name for s in sets], _NAME))
    table = np.zeros((len(mesh.elements), 6), np.int32)
    for at, kind in enumerate(mesh.elements):
        table[at, : len(_SIDES[kind])] = _SIDES[kind]
    for k, side_set in enumerate(sets, 1):
        element = np.concatenate(list(side_set.element.values()))
        side = np.concatenate(list(side_set.side.values()))
        netcdf.dimensions[f"num_side_ss{k}"] = len(element)
        netcdf.add(f"elem_ss{k}", (f"num_side_ss{k}",), number[element].astype(np.int32))
        netcdf.add(f"side_ss{k}", (f"num_side_ss{k}",), table[kind_of[element], side])


def _add_polyhedra(netcdf: NetcdfFile, mesh: PolyhedralMesh) -> None:
    cells = CellFaces(mesh)
    faces = np.diff(cells.begin)
    words = solver_names(mesh.block_names, _LONGEST_NAME)
    present = np.unique(mesh.cell_block).tolist()
    _add_blocks(netcdf, [words[block] for block in present])
    if not present:
        return
    count = len(mesh.face_cells)
    netcdf.dimensions |= {"num_face": count, "num_fa_blk": 1, "num_fa_in_blk1": count}
    netcdf.dimensions["num_nod_per_fa1"] = len(mesh.face_vertices)
    netcdf.add("fa_status", ("num_fa_blk",), np.ones(1, np.int32))
    netcdf.add("fa_prop1", ("num_fa_blk",), np.ones(1, np.int32), name="ID")
    netcdf.add("fa_names", ("num_fa_blk", "len_name"), characters(["faces"], _NAME))
    corners = (mesh.face_vertices + 1).astype(np.int32)
    netcdf.add("fbconn1", ("num_nod_per_fa1",), corners, elem_type="nsided")
    netcdf.add("fbepecnt1", ("num_fa_in_blk1",), np.diff(mesh.face_offsets).astype(np.int32))
    for k, block in enumerate(present, 1):
        in_block = mesh.cell_block == block
        used = cells.face[np.repeat(in_block, faces)]
        netcdf.dimensions |= {f"num_el_in_blk{k}": int(in_block.sum()), f"num_fac_per_el{k}": len(used)}
        netcdf.add(f"facconn{k}", (f"num_fac_per_el{k}",), (used + 1).astype(np.int32), elem_type="nfaced")
        netcdf.add(f"ebepecnt{k}", (f"num_el_in_blk{k}",), faces[in_block].astype(np.int32))
