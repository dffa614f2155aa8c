# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids of MODFLOW 6, text: discretization by vertices (DISV) and unstructured (DISU) (Langevin and others
2017, USGS TM6-A55; the packages' input instructions).

Both stand for the volumes of the mesh exactly: a cell's thickness is its volume over its area in plan.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ...base.atomic import Outputs
from ...base.errors import UsageError, place_text
from ...base.text import Step
from ...base.units import MODEL_UNIT
from ...simulation import CORNERS, PlanMesh, PolyhedralMesh, VolumeMesh
from ...simulation.elements import OUTWARD
from ..encodings.text_rows import write_rows, write_wrapped
from .vtu import CellFaces

_A_LINE = 10
_NARROWEST = 1e-9  # of a cell's extent: through less nothing flows, and solvers do not converge
_NO_ORDER = "MODFLOW 6 wants cells in an order from the top to the base"
_OTHERS = "write another format, such as .vtu or .foam"
_UNITS = {"m": "METERS", "cm": "CENTIMETERS", "ft": "FEET", "us-ft": "FEET"}


def write_disv(mesh: VolumeMesh, path: Path, outputs: Outputs, step: Step, unit: str = MODEL_UNIT) -> None:
    """Writes the package DISV of a mesh whose elements stand in columns, a cell for each layer and column.
    Where a layer has no element, its cell is a pass-through (idomain -1), where the whole column has none it
    is inactive (0). NAME_block.txt beside it has the number of the block (from 1) of each cell, 0 for none,
    layer after layer, as OPEN/CLOSE reads it. Raises UsageError."""
    beside = path.with_name(f"{path.stem}_block.txt")
    with outputs.file(path) as file, outputs.file(beside) as blocks:
        _write_disv(mesh, file, blocks, step, unit)


def _write_disv(mesh: VolumeMesh, file: BinaryIO, blocks: BinaryIO, step: Step, unit: str) -> None:
    plan = mesh.plan
    if plan is None:
        raise UsageError("DISV needs a mesh of layered columns; write a DISU grid (.disu), or another format")
    columns, layers = len(plan.triangles), plan.layers
    cells, volumes, blocks_of = [], [], []
    for kind, elements in mesh.elements.items():
        cells.append(plan.layer[kind].astype(np.int64) * columns + plan.column[kind])
        volumes.append(element_volumes(mesh.points, kind, elements))
        blocks_of.append(mesh.element_block[kind])
    cell, volume, block = (np.concatenate([*parts, np.empty(0)]) for parts in (cells, volumes, blocks_of))
    cell = cell.astype(np.int64)
    corners = plan.vertices[plan.triangles]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    thickness = np.bincount(cell, volume, layers * columns).reshape(layers, columns) / area
    order = np.lexsort((volume, cell))  # the largest element of a cell says its block
    of_cell = np.zeros(layers * columns, np.int64)
    of_cell[cell[order]] = block[order].astype(np.int64) + 1
    top = _column_tops(mesh, plan)
    bottom = top - np.cumsum(thickness, axis=0)
    domain = np.where(thickness > 0, 1, np.where(thickness.sum(axis=0) > 0, -1, 0))
    step(0.3)
    head = f"BEGIN OPTIONS\n  LENGTH_UNITS {_UNITS.get(unit, 'UNKNOWN')}\nEND OPTIONS\n\n"
    head += f"BEGIN DIMENSIONS\n  NLAY {layers}\n  NCPL {columns}\n  NVERT {len(plan.vertices)}\n"
    file.write(f"{head}END DIMENSIONS\n\nBEGIN GRIDDATA\n  TOP\n".encode())
    _array(file, top)
    for name, values in (("BOTM", bottom), ("IDOMAIN", domain)):
        file.write(f"  {name} LAYERED\n".encode())
        for layer in values:
            _array(file, layer)
    file.write(b"END GRIDDATA\n\nBEGIN VERTICES\n")
    write_rows(file, "  %d %r %r", np.arange(1, len(plan.vertices) + 1), plan.vertices)
    file.write(b"END VERTICES\n\nBEGIN CELL2D\n")
    around = plan.triangles[:, ::-1] + 1  # clockwise there
    write_rows(file, "  %d %r %r 3 %d %d %d", np.arange(1, columns + 1), corners.mean(axis=1), around)
    file.write(b"END CELL2D\n")
    _numbers(blocks, of_cell)
    step(1.0)


def _column_tops(mesh: VolumeMesh, plan: PlanMesh) -> np.ndarray:
    """(T,) the height of the top of each column: the mean of the highest points over its corners."""
    _, place = np.unique(mesh.points[:, :2], axis=0, return_inverse=True)
    parts: list[list[np.ndarray]] = [[], [], []]
    for kind, elements in mesh.elements.items():
        parts[0].append(np.repeat(plan.column[kind], CORNERS[kind]))
        parts[1].append(place.ravel()[elements.ravel()])
        parts[2].append(mesh.points[elements.ravel(), 2])
    columns, places, heights = (np.concatenate([*part, np.empty(0)]) for part in parts)
    order = np.lexsort((heights, places, columns))
    columns, places, heights = columns.astype(np.int64)[order], places[order], heights[order]
    is_last = np.append((columns[1:] != columns[:-1]) | (places[1:] != places[:-1]), True)[: len(columns)]
    count = len(plan.triangles)
    number = np.bincount(columns[is_last], minlength=count)
    total = np.bincount(columns[is_last], heights[is_last], count)
    return np.divide(total, number, out=np.zeros(count), where=number > 0)


def element_volumes(points: np.ndarray, kind: str, elements: np.ndarray) -> np.ndarray:
    """(E,) float64, of straight elements; faces of four corners are taken as divided at their mean."""
    corners = points[elements]
    middle = corners.mean(axis=1)
    total = np.zeros(len(elements))
    for local in OUTWARD[kind]:
        face = corners[:, local] - middle[:, None]
        center = face.mean(axis=1)
        for k in range(len(local)):
            p, q = face[:, k], face[:, (k + 1) % len(local)]
            total += np.einsum("ij,ij->i", center, np.cross(p, q)) / 6
    return total


def write_disu(
    mesh: PolyhedralMesh, path: Path, outputs: Outputs, step: Step, unit: str = MODEL_UNIT
) -> None:
    """Writes the package DISU of polyhedra. Cells that share vertical faces are connected sideways (ihc 1),
    with the width that gives the area of these faces at their mean thickness, others one above the other
    (ihc 0), by the area in plan. Cells are numbered from the top, as MODFLOW 6 wants it: of two that are one
    above the other the upper one comes first. Tops of lower cells may be above bottoms of upper ones by what
    surfaces rise within a cell, which the option VERTICAL_OFFSET_TOLERANCE allows. NAME_disu_block.txt is as
    of write_disv, so that both grids may have one name.

    Raises UsageError where no such numbers exist, and for faults and bodies that are not vertical."""
    beside = path.with_name(f"{path.stem}_disu_block.txt")
    with outputs.file(path) as file, outputs.file(beside) as blocks:
        _write_disu(mesh, file, blocks, step, unit)


def _write_disu(mesh: PolyhedralMesh, file: BinaryIO, blocks: BinaryIO, step: Step, unit: str) -> None:
    cells = mesh.cells
    normals, centers = _face_areas(mesh)
    order = _from_top(mesh, normals)
    number = np.empty(cells, np.int64)
    number[order] = np.arange(cells)
    mesh = replace(
        mesh,
        face_cells=np.append(number, -1)[mesh.face_cells].astype(np.int32),
        cell_block=mesh.cell_block[order],
    )
    owner, other = mesh.face_cells.T
    lever = np.zeros((cells, 3))
    faces = CellFaces(mesh)
    of_side = np.repeat(np.arange(cells), np.diff(faces.begin))
    outward = np.where(faces.turned[:, None], -normals[faces.face], normals[faces.face])
    anchor = mesh.points[mesh.face_vertices[mesh.face_offsets[faces.face[faces.begin[:-1]]]]]
    spoke = centers[faces.face] - anchor[of_side]
    share = np.einsum("ij,ij->i", spoke, outward) / 3
    volume = np.bincount(of_side, share, cells)
    plan = np.bincount(of_side, np.maximum(outward[:, 2], 0), cells)
    for axis in range(3):  # of the pyramids from the anchor to each face
        lever[:, axis] = np.bincount(of_side, 0.75 * share * spoke[:, axis], cells)
    lowest, highest = _height_range(mesh, faces)
    # Of cells as narrow as the rounding of their corners volumes tell nothing.
    is_sound = (volume > 0) & (volume <= plan * (highest - lowest))
    center = anchor + np.divide(lever, volume[:, None], out=np.zeros_like(lever), where=is_sound[:, None])
    thickness = np.divide(volume, plan, out=(highest - lowest) / 2, where=is_sound)
    center[:, 2] = np.where(is_sound, center[:, 2], (lowest + highest) / 2)
    step(0.3)
    inner = np.flatnonzero(other >= 0)
    low, high = np.minimum(owner, other)[inner], np.maximum(owner, other)[inner]
    pair, first, of_pair = np.unique(
        low.astype(np.int64) * cells + high, return_index=True, return_inverse=True
    )
    above = np.bincount(of_pair, np.abs(normals[inner, 2]), len(pair))
    beside = np.bincount(of_pair, np.hypot(*normals[inner, :2].T) * _upright(normals[inner]), len(pair))
    is_beside = beside > above
    low, high = low[first], high[first]
    face = inner[first]
    mean = (thickness[low] + thickness[high]) / 2
    size = np.where(is_beside, np.divide(beside, mean, out=np.zeros(len(mean)), where=mean > 0), above)
    length = np.linalg.norm(normals[face], axis=1)
    reach = []
    for cell in (low, high):
        away = np.abs(np.einsum("ij,ij->i", centers[face] - center[cell], normals[face]))
        across = np.divide(away, length, out=np.zeros(len(face)), where=length > 0)
        reach.append(np.where(is_beside, across, thickness[cell] / 2))
    least = np.minimum(plan[low], plan[high])
    is_wide = size > _NARROWEST * np.where(is_beside, np.sqrt(least), least)
    low, high, size, is_beside = (column[is_wide] for column in (low, high, size, is_beside))
    reach = [distance[is_wide] for distance in reach]
    top, bottom = center[:, 2] + thickness / 2, center[:, 2] - thickness / 2
    overlap = (top[high] - bottom[low])[~is_beside].max(initial=0.0)
    step(0.5)
    one = np.concatenate([np.arange(cells), low, high])
    two = np.concatenate([np.arange(cells), high, low])
    order = np.lexsort((two, two != one, one))  # each cell first names itself
    none = np.zeros(cells)
    values = {
        "JA": two[order] + 1,
        "IHC": np.concatenate([none, is_beside, is_beside])[order].astype(np.int64),
        "CL12": np.concatenate([none, reach[0], reach[1]])[order],
        "HWVA": np.concatenate([none, size, size])[order],
    }
    head = f"BEGIN OPTIONS\n  LENGTH_UNITS {_UNITS.get(unit, 'UNKNOWN')}\n"
    head += f"  VERTICAL_OFFSET_TOLERANCE {float(overlap) * 1.001!r}\n" if overlap > 0 else ""
    head += "END OPTIONS\n\n"
    head += f"BEGIN DIMENSIONS\n  NODES {cells}\n  NJA {len(one)}\nEND DIMENSIONS\n\nBEGIN GRIDDATA\n"
    file.write(head.encode())
    for name, array in (
        ("TOP", top),
        ("BOT", bottom),
        ("AREA", plan),
    ):
        file.write(f"  {name}\n".encode())
        _array(file, array)
    file.write(b"END GRIDDATA\n\nBEGIN CONNECTIONDATA\n  IAC\n")
    _array(file, np.bincount(one, minlength=cells))
    for name, array in values.items():
        file.write(f"  {name}\n".encode())
        _array(file, array)
    file.write(b"END CONNECTIONDATA\n")
    _numbers(blocks, mesh.cell_block + 1)
    step(1.0)


def _height_range(mesh: PolyhedralMesh, faces: CellFaces) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest corner of each cell, (C,) each."""
    heights = mesh.points[mesh.face_vertices, 2]

    def extreme(of: np.ufunc) -> np.ndarray:
        return of.reduceat(of.reduceat(heights, mesh.face_offsets[:-1])[faces.face], faces.begin[:-1])

    return extreme(np.minimum), extreme(np.maximum)


def _from_top(mesh: PolyhedralMesh, normals: np.ndarray) -> np.ndarray:
    """(C,) the cells in an order in which each comes before those below it, else as they are."""
    first, second = mesh.face_cells.T
    rise = np.abs(normals[:, 2])
    plan = np.bincount(first, rise, mesh.cells + 1) / 2
    plan += np.bincount(np.where(second < 0, mesh.cells, second), rise, mesh.cells + 1) / 2
    wide = rise > _NARROWEST * np.minimum(plan[first], plan[second])
    flat = np.flatnonzero((second >= 0) & wide & ~_upright(normals))
    on = mesh.face_surface[flat]
    inclined = on[(on >= 0) & (np.append(mesh.surface_kind, 0)[np.maximum(on, -1)] != 0)]
    if len(inclined):
        raise UsageError(f"{_NO_ORDER}; '{mesh.surface_names[inclined[0]]}' is inclined; {_OTHERS}")
    first, second = mesh.face_cells[flat].T
    rises = normals[flat, 2] > 0  # out of the first cell
    above, below = np.where(rises, second, first), np.where(rises, first, second)
    if (above < below).all():
        return np.arange(mesh.cells)
    waits = np.bincount(below, minlength=mesh.cells)  # for so many cells above
    by_upper = np.argsort(above, kind="stable")
    begins = np.searchsorted(above[by_upper], np.arange(mesh.cells + 1))
    ready = np.flatnonzero(waits == 0)
    rounds = []
    while len(ready):
        rounds.append(ready)
        counts = begins[ready + 1] - begins[ready]
        rows = np.repeat(begins[ready] - np.cumsum(counts) + counts, counts) + np.arange(counts.sum())
        freed, number = np.unique(below[by_upper[rows]], return_counts=True)
        waits[freed] -= number
        ready = freed[waits[freed] == 0]
    order = np.concatenate([np.empty(0, np.int64), *rounds])
    if len(order) < mesh.cells:
        cell = int(np.flatnonzero(waits)[0])
        face = int(np.flatnonzero((mesh.face_cells == cell).any(axis=1))[0])
        place = mesh.points[mesh.face_vertices[mesh.face_offsets[face]]]
        raise UsageError(
            f"{_NO_ORDER}; near {place_text(place)} cells are above and below one another, as in folds; "
            f"{_OTHERS}"
        )
    return order


def _upright(normals: np.ndarray) -> np.ndarray:
    """Which faces are vertical, up to the rounding of their corners."""
    return np.abs(normals[:, 2]) <= _NARROWEST * np.linalg.norm(normals, axis=1)


def _face_areas(mesh: PolyhedralMesh) -> tuple[np.ndarray, np.ndarray]:
    """The area vector of each face, out of its first cell, and the centroid of its area, (F, 3) each."""
    sizes = np.diff(mesh.face_offsets)
    first = np.repeat(mesh.face_offsets[:-1], sizes)
    following = np.arange(1, len(mesh.face_vertices) + 1)
    following[mesh.face_offsets[1:] - 1] = mesh.face_offsets[:-1]
    corners = mesh.points[mesh.face_vertices]
    origin = corners[first]
    p, q = corners - origin, corners[following] - origin
    part = np.cross(p, q) / 2
    begins = mesh.face_offsets[:-1]
    normals = np.add.reduceat(part, begins, axis=0) if len(begins) else np.zeros((0, 3))
    length = np.linalg.norm(normals, axis=1)
    unit = np.divide(normals, length[:, None], out=np.zeros_like(normals), where=length[:, None] > 0)
    weight = np.einsum("ij,ij->i", part, np.repeat(unit, sizes, axis=0))
    moment = np.add.reduceat(weight[:, None] * (p + q) / 3, begins, axis=0) if len(begins) else normals
    shift = np.divide(moment, length[:, None], out=np.zeros_like(moment), where=length[:, None] > 0)
    return normals, corners[begins] + shift if len(begins) else normals


def _array(file: BinaryIO, values: np.ndarray) -> None:
    file.write(b"    INTERNAL FACTOR 1\n")
    _numbers(file, values)


def _numbers(file: BinaryIO, values: np.ndarray) -> None:
    write_wrapped(file, " %d" if values.dtype.kind in "iu" else " %r", values, _A_LINE)
