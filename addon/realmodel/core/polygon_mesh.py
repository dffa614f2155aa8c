# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks and cells of a model as meshes of polygons, complete with their edges, as programs that draw take
them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from .work import Cancel, native_module, run

if TYPE_CHECKING:
    from .model import Model


@dataclass(frozen=True, eq=False)
class PolygonMesh:
    """A mesh of polygons.

    coordinates: (V, 3) float32. offsets: (F + 1,) int32, where the corners of each polygon begin, and where
    the last end. corners: (C,) int32, vertex numbers, counter-clockwise seen from outside. face_surface:
    (F,) int32, the global index of the surface that each polygon lies on (-1 a wall, -2 the flat base), or
    None. edges: (E, 2) int32, each once, and corner_edges: (C,) int32, for each corner the edge from it to
    the next; both None where whoever takes the mesh is to find them. smooth: shaded without breaks.
    """

    coordinates: np.ndarray
    offsets: np.ndarray
    corners: np.ndarray
    face_surface: np.ndarray | None = None
    edges: np.ndarray | None = None
    corner_edges: np.ndarray | None = None
    smooth: bool = False

    @property
    def polygons(self) -> int:
        """How many polygons there are."""
        return len(self.offsets) - 1


def of_triangles(coordinates: np.ndarray, triangles: np.ndarray, smooth: bool = False) -> PolygonMesh:
    """A mesh of triangles, (T, 3) int32, with its edges."""
    offsets = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int32)
    corners = np.ascontiguousarray(triangles, np.int32).reshape(-1)
    edges, corner_edges = native_module().polygon_edges(offsets, corners, len(coordinates))
    return PolygonMesh(coordinates, offsets, corners, None, edges, corner_edges, smooth)


def of_surfaces(model: Model, origin: np.ndarray) -> list[PolygonMesh | None]:
    """For each surface of a model, by its global index, the faces that are left of it; None where it is all
    eroded. origin: as for `of_blocks`."""
    order = np.argsort(model.face_surface, kind="stable")
    begin = np.searchsorted(model.face_surface[order], np.arange(len(model.surface_names) + 1))
    found: list[PolygonMesh | None] = []
    for first, last in pairwise(begin.tolist()):
        if first == last:
            found.append(None)
            continue
        faces = order[first:last]
        # The cell that a face is numbered for lies below it or above; seen from above all turn the same way.
        offsets, corners = model.face_corners(faces, _seen_from_below(model, faces))
        used, corners = np.unique(corners, return_inverse=True)
        coordinates = (model.vertices[used] - origin).astype(np.float32)
        offsets, corners = offsets.astype(np.int32), corners.astype(np.int32).ravel()
        edges, corner_edges = native_module().polygon_edges(offsets, corners, len(used))
        found.append(PolygonMesh(coordinates, offsets, corners, None, edges, corner_edges))
    return found


def _seen_from_below(model: Model, faces: np.ndarray) -> np.ndarray:
    """(N,) bool: the faces whose corners go clockwise seen from above."""
    offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    x, y = model.vertices[corners, 0], model.vertices[corners, 1]
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    first = np.repeat(offsets[:-1], np.diff(offsets))
    x, y = x - x[first], y - y[first]
    return np.add.reduceat(x * y[following] - y * x[following], offsets[:-1]) < 0


def of_blocks(
    model: Model, origin: np.ndarray, threads: int = 0, cancel: Cancel | None = None
) -> list[PolygonMesh | None]:
    """For each block of a model its closed boundary, all its parts together; None where it has no cells.

    origin: (3,) float64, taken off the coordinates before they are rounded to 32 bits. cancel: as for
    `build`. Raises Cancelled, BuildFailed.
    """
    return _shells(model, origin, None, threads, cancel)


def of_cells(
    model: Model, origin: np.ndarray, shrink: float, threads: int = 0, cancel: Cancel | None = None
) -> list[PolygonMesh | None]:
    """For each block of a model all its cells, each by itself with vertices of its own that are drawn towards
    their mean by the factor `shrink`. Otherwise as `of_blocks`."""
    return _shells(model, origin, shrink, threads, cancel)


def _shells(model, origin, shrink, threads, cancel) -> list[PolygonMesh | None]:
    def task(work):
        return work.native(
            native_module().complex_shells,
            model.vertices,
            model.face_offsets,
            model.face_vertices,
            model.face_cells,
            model.cell_block,
            len(model.blocks),
            tuple(float(value) for value in origin),
            shrink,
            threads,
        )

    found = []
    for arrays in run(task, cancel=cancel):
        if arrays is None:
            found.append(None)
            continue
        coordinates, offsets, corners, faces, edges, corner_edges = arrays
        surface = model.face_surface[faces]
        found.append(PolygonMesh(coordinates, offsets, corners, surface, edges, corner_edges))
    return found
