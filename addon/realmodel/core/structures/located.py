# SPDX-License-Identifier: GPL-3.0-or-later
"""In which cell of a finished model points lie."""

from __future__ import annotations

import numpy as np

from .closed_form import heights_in_plane, plan_candidates
from .exact import orient2d, orient3d

OUTSIDE = -1


def fanned(offsets: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Polygons as triangles (T, 3) from their first corners, and the polygon (T,) of each."""
    size = np.diff(offsets)
    owner = np.repeat(np.arange(len(size)), np.maximum(size - 2, 0))
    first = offsets[owner]
    at = first + np.arange(len(owner)) - np.repeat(np.cumsum(size - 2) - (size - 2), size - 2) + 1
    return np.column_stack([corners[first], corners[at], corners[at + 1]]), owner


def cells_at(model, points: np.ndarray) -> np.ndarray:
    """(N,) the cell that each point (N, 3) lies in, OUTSIDE for none: what is below the nearest face above.

    Signs are exact for the triangles into which faces are divided; points on a face are in a cell beside it.
    """
    triangles, face = fanned(model.face_offsets, model.face_vertices)
    corners = model.vertices[triangles]
    flat = orient2d(*corners[:, :, :2].transpose(1, 0, 2)) == 0
    corners, face = corners[~flat], face[~flat]
    found = np.full(len(points), OUTSIDE, np.int64)
    nearest = np.full(len(points), np.inf)
    for rows, above in plan_candidates(points[:, :2], corners):
        a, b, c = corners[above].transpose(1, 0, 2)
        p = points[rows]
        turns = [orient2d(u[:, :2], v[:, :2], p[:, :2]) for u, v in ((a, b), (b, c), (c, a))]
        turn = orient2d(a[:, :2], b[:, :2], c[:, :2])
        within = np.all([each * turn >= 0 for each in turns], axis=0)
        within &= orient3d(a, b, c, p) * turn < 0
        rows, a, b, c, above, turn = (each[within] for each in (rows, a, b, c, above, turn))
        height = heights_in_plane(a, b, c, points[rows, :2])
        order = np.lexsort((height, rows))
        first = order[np.concatenate([[True], np.diff(rows[order]) > 0])] if len(order) else order
        closer = first[height[first] < nearest[rows[first]]]
        nearest[rows[closer]] = height[closer]
        below = np.where(turn[closer] > 0, 0, 1)
        found[rows[closer]] = model.face_cells[face[above[closer]], below]
    return found
