# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of blocks with fewer polygons, for display."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.triangles import fanned
from .polygon_mesh import PolygonMesh, of_triangles

_UP, _DOWN = 1, 2


def coarsened(shape: PolygonMesh, size: float) -> PolygonMesh | None:
    """A closed mesh as triangles, of which the vertices over each square of the plan, `size` wide, are one at
    their mean: those of faces that look up, those of faces that look down, those of both and those of walls
    each for themselves, so that thin layers stay. It is closed again; None where nothing is left."""
    at = shape.coordinates.astype(np.float64)
    triangles, faces = fanned(shape.offsets, shape.corners)
    a, b, c = at[triangles, :2].transpose(1, 0, 2)
    turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    turn = np.bincount(faces, turn, shape.polygons)[faces]
    if shape.face_surface is not None:
        turn[shape.face_surface[faces] == -1] = 0.0
    sides = np.zeros(len(at), np.int64)
    for side, seen in ((_UP, turn > 0), (_DOWN, turn < 0)):
        sides[np.unique(triangles[seen])] |= side
    squares = np.floor(at[:, :2] / size).astype(np.int64)
    _, number = np.unique(np.column_stack([squares, sides]), axis=0, return_inverse=True)
    number = number.reshape(-1)
    count = np.bincount(number)
    mean = np.column_stack([np.bincount(number, at[:, axis]) for axis in range(3)]) / count[:, None]
    left = _without_pairs(number[triangles])
    if not len(left):
        return None
    used, left = np.unique(left, return_inverse=True)
    return of_triangles(mean[used].astype(np.float32), left.reshape(-1, 3).astype(np.int32))


def joined(shapes: Sequence[PolygonMesh]) -> PolygonMesh:
    """Meshes of triangles joined to one."""
    first = np.cumsum([0, *(len(shape.coordinates) for shape in shapes)])
    triangles = [
        shape.corners.reshape(-1, 3) + start for shape, start in zip(shapes, first[:-1], strict=True)
    ]
    return of_triangles(
        np.concatenate([shape.coordinates for shape in shapes]), np.concatenate(triangles).astype(np.int32)
    )


def _without_pairs(triangles: np.ndarray) -> np.ndarray:
    """Triangles with three different corners, without pairs that coincide with opposite orientation."""
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    order = np.sort(triangles, axis=1)
    _, first, same = np.unique(order, axis=0, return_index=True, return_inverse=True)
    least = triangles.argmin(axis=1)
    rows = np.arange(len(triangles))
    forward = triangles[rows, (least + 1) % 3] < triangles[rows, (least + 2) % 3]
    net = np.bincount(same.reshape(-1), np.where(forward, 1, -1), len(first)).astype(np.int64)
    order = order[first]
    order[net < 0] = order[net < 0][:, [0, 2, 1]]
    return np.repeat(order, np.abs(net), axis=0)
