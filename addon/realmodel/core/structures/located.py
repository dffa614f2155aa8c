# SPDX-License-Identifier: GPL-3.0-or-later
"""In which cell of a finished model points lie."""

from __future__ import annotations

import numpy as np

from .closed_form import PlanGrid, heights_in_plane
from .exact import orient2d, orient3d

OUTSIDE = -1


def fanned(offsets: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Polygons as triangles (T, 3) from their first corners, and the polygon (T,) of each."""
    size = np.diff(offsets)
    owner = np.repeat(np.arange(len(size)), np.maximum(size - 2, 0))
    first = offsets[owner]
    at = first + np.arange(len(owner)) - np.repeat(np.cumsum(size - 2) - (size - 2), size - 2) + 1
    return np.column_stack([corners[first], corners[at], corners[at + 1]]), owner


class Locator:
    """Tells in which cells of a model points lie: what is below the nearest face above."""

    def __init__(self, model):
        triangles, face = fanned(model.face_offsets, model.face_vertices)
        corners = model.vertices[triangles]
        plan = corners[:, :, :2]
        flat = (plan == plan[:, [1, 2, 0]]).all(axis=2).any(axis=1)  # two corners above one another
        turn = np.zeros(len(corners), np.int8)
        turn[~flat] = orient2d(*plan[~flat].transpose(1, 0, 2))
        self.corners, self.turn = corners[turn != 0], turn[turn != 0]
        self.grid = PlanGrid(self.corners)
        self.below = model.face_cells[face[turn != 0], np.where(self.turn > 0, 0, 1)]

    def cells(self, points: np.ndarray) -> np.ndarray:
        """(N,) the cell that each point (N, 3) lies in, OUTSIDE for none. Signs are exact for the triangles
        into which faces are divided; points on a face are in a cell beside it."""
        found = np.full(len(points), OUTSIDE, np.int64)
        nearest = np.full(len(points), np.inf)
        for rows, above in self.grid.over(points[:, :2]):
            a, b, c = self.corners[above].transpose(1, 0, 2)
            p, turn = points[rows], self.turn[above]
            turns = [orient2d(u[:, :2], v[:, :2], p[:, :2]) for u, v in ((a, b), (b, c), (c, a))]
            within = np.flatnonzero(np.all([each * turn >= 0 for each in turns], axis=0))
            rows, above, a, b, c, p, turn = (each[within] for each in (rows, above, a, b, c, p, turn))
            over = np.flatnonzero(orient3d(a, b, c, p) * turn < 0)
            rows, above, a, b, c, p = (each[over] for each in (rows, above, a, b, c, p))
            if not len(rows):
                continue
            height = heights_in_plane(a, b, c, p[:, :2])
            order = np.lexsort((height, rows))
            first = order[np.concatenate([[True], np.diff(rows[order]) > 0])]
            closer = first[height[first] < nearest[rows[first]]]
            nearest[rows[closer]] = height[closer]
            found[rows[closer]] = self.below[above[closer]]
        return found
