# SPDX-License-Identifier: GPL-3.0-or-later
"""In which cell of a finished model points lie."""

from __future__ import annotations

import numpy as np

from ..base.fans import fanned
from .closed_form import PlanGrid, triangles_above

OUTSIDE = -1
_FINEST = 1024  # cells of the grid of points along an axis


class Locator:
    """Finds the cells of a model in which points lie: those whose faces go around them."""

    def __init__(self, model):
        self._model = model
        self._low, self._high = np.empty((2, 0, 2))
        if len(model.face_surface):
            plan = model.vertices[model.face_vertices, :2]
            first = model.face_offsets[:-1]
            self._low, self._high = np.minimum.reduceat(plan, first), np.maximum.reduceat(plan, first)

    def cells(self, points: np.ndarray) -> np.ndarray:
        """(N,) the cell that each point (N, 3) lies in, OUTSIDE for none; the first one where rounding made
        cells overlap. Exact for the triangles into which faces are divided; a point on a face is above it."""
        found = np.full(len(points), OUTSIDE, np.int64)
        count = len(self._model.cell_block)
        corners, cells = self._triangles_over(points)
        for rows, above, turn in triangles_above(points, corners, PlanGrid(corners)):
            # a face is seen counter-clockwise from outside of its first cell
            keys = rows[:, None] * (count + 1) + cells[above] + 1
            key, number = np.unique(keys, return_inverse=True)
            winding = np.zeros(len(key), np.int64)
            np.add.at(winding, number.reshape(keys.shape), np.column_stack([turn, -turn]))
            row, cell = np.divmod(key[winding > 0], count + 1)
            row, first = np.unique(row[cell > 0], return_index=True)
            found[row] = cell[cell > 0][first] - 1
        return found

    def _triangles_over(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The triangles (T, 3, 3) of the faces that lie over or under a point, some others among them, and
        their cells (T, 2)."""
        faces = np.flatnonzero(_hold_any(self._low, self._high, points[:, :2]))
        offsets, corners = self._model.face_corners(faces, np.zeros(len(faces), bool))
        triangles, face = fanned(offsets, corners)
        places = self._model.vertices[triangles]
        plan = places[:, :, :2]
        is_upright = (plan == plan[:, [1, 2, 0]]).all(axis=2).any(axis=1)  # two corners above one another
        return places[~is_upright], self._model.face_cells[faces[face[~is_upright]]]


def _hold_any(low: np.ndarray, high: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """(B,) bool: of boxes in plan, corners (B, 2), all that hold one of the points (N, 2), and some that only
    come near one: those that meet a cell of a grid with a point in it."""
    if not len(plan):
        return np.zeros(len(low), bool)
    origin, size = plan.min(axis=0), np.ptp(plan, axis=0)
    count = int(np.clip(16 * np.sqrt(len(plan)), 1, _FINEST))
    step = np.where(size > 0, size / count, 1.0)

    def cells_of(places: np.ndarray) -> np.ndarray:  # never falls where a coordinate rises
        return np.clip((places - origin) / step, 0, count - 1).astype(np.int64)

    sums = np.zeros((count + 1, count + 1), np.int64)  # of the points in all cells before one
    np.add.at(sums[1:, 1:], tuple(cells_of(plan).T), 1)
    sums = sums.cumsum(axis=0).cumsum(axis=1)
    (x, y), (next_x, next_y) = cells_of(low).T, cells_of(high).T + 1
    return sums[next_x, next_y] - sums[x, next_y] - sums[next_x, y] + sums[x, y] > 0
